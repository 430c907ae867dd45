"""What moves or changes in an office, by itself or on command: people, doors, boxes, lamps, daylight."""
