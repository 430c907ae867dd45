"""Brains of running sessions, kept on disk."""
