"""Runs as data, and made again from that: runs that keep themselves, situations, branches and moments of the past."""
