"""The robot's sensors: sonars, laser, bumper, odometry, scene numbers and the camera's image."""
