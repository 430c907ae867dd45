"""A world as data, its file and its checks, and where a robot fits in it."""

from sim2d.world import own_worlds as own_worlds

DEFAULT_WORLD = "office"
