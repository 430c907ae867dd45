"""The bars of the map that stays true: `python -m benchmarks.true_map [ROW ...]`. rows.py lists them."""
