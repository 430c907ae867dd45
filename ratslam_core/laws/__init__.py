"""What is true of a brain between any two steps, part by part: types, shapes, ranges, and which parts must agree.

Compiled code does not check where it reads and writes; it relies on these laws. They are checked for every state that
comes from outside (`brain_file.py`), and in test_laws.py for running brains.
"""

from ratslam_core.laws.brain import check

__all__ = ["check"]
