"""Recordings of real robots: what is in them, and the engine that plays them."""
