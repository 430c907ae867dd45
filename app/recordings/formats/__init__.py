"""Readers of recordings, one file a format. Each gives a stream of what was sensed; `streamed.py` makes moments of it."""
