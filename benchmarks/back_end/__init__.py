"""False closures against the back end, on graphs: `python -m benchmarks.back_end`."""
