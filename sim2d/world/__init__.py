"""A world as data, its file, what is wrong with it, and where a robot fits in it."""
