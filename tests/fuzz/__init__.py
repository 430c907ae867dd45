"""Spoilt files and messages by the thousand. `python -m tests.fuzz --count 10000 --seed 1`."""
