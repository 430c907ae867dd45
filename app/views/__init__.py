"""What people look at, built from a session without changing it."""
