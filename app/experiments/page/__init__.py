"""The page of an experiment: one HTML file that holds everything it shows, and loads nothing."""
