"""The robot's camera: which walls it sees, their textures, their light, and reflections in glass."""
