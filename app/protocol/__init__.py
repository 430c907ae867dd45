"""One trial of an experiment: a world, a robot, an engine, a seed, and a protocol that takes them through it."""
