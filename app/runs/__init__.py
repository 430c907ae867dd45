"""Runs that keep themselves: on disk, as their beginning and the orders that were given."""
