"""A world as data, its file and its checks, and where a robot fits in it."""
