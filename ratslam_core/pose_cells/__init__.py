"""Pose cells: the continuous attractor network. ACRA 2004 section 4."""
