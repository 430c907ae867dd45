"""Sparse systems and shortest ways, which know nothing of RatSLAM."""
