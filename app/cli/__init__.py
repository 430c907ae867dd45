"""The command `ratslam`: one file for each verb."""
