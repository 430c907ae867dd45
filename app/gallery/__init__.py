"""What the page's gallery of experiments shows: the catalogue, its pictures, and the trials that were run here."""
