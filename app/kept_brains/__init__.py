"""Brains of running sessions, kept on the disk."""
