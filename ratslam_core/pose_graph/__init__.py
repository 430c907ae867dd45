"""Experiences, the transitions between them, and map correction, which moves the ones until they fit the others."""
