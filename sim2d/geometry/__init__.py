"""Points, segments and rays in the plane, and cells that hang together. Knows no world."""
