"""What people look at, built from a session that is left as it is."""
