"""Solvers for sparse systems and for shortest ways. They know nothing of RatSLAM."""
