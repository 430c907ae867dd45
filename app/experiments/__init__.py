"""Many trials: run beside each other, kept in one file, and summed up with intervals."""
