"""From the command to the first tick, and out again."""
