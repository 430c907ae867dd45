"""What the robot's camera sees: which walls, how much of them, how bright, and mirrored in what."""
