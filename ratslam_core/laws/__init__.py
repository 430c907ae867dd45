"""What is true of a brain between any two steps, noun by noun: types, shapes, ranges, and who must agree with whom.

Compiled code does not look where it reads and writes; it relies on these. They are asked where a state comes from outside
(`brain_file.py`), and of living brains in test_laws.py.
"""

from ratslam_core.laws.brain import check

__all__ = ["check"]
