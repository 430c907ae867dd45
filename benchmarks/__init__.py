"""What is measured, beside its bars. Each module with a main is run as `python -m benchmarks.NAME`, and ends as `ratslam` does:
after Ctrl+C in a line, with exit code 130."""

import sys

import ratslam_live as ratslam_live  # our packages, whatever else has their names
from app.startup.ending import end_in_words

if sys.argv[0] == "-m":  # Python says so while it imports the package of a module that it is going to run
    end_in_words()
