"""What moves and changes in an office by itself or when told: people, doors, boxes, lamps, daylight."""
