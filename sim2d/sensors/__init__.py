"""What the robot senses: sonars, laser, bumper, odometry, scene numbers, and the camera's picture."""
