"""Lessons: one idea of the papers each, as a file that says what to set up, to ask, to show and to promise."""
