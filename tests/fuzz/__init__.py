"""Files and messages that somebody has spoilt, by the thousand. `python -m tests.fuzz --count 10000 --seed 1`."""
