"""The robot's body, and the obstacles it can run into, in pymunk."""
