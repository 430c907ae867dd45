"""Points, segments and rays in the plane, and connected cells of a grid. It knows nothing of worlds."""
