"""The robot's body and what it can run into, in pymunk."""
