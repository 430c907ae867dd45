"""What the commands act on: the run that is on, and how it is stopped and stepped."""
