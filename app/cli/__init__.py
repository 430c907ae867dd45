"""The command `ratslam`: a file for each of its verbs."""
