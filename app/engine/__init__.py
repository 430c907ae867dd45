"""What commands act on: the current run, and how it is stepped, paced and stopped."""
