"""Importing floor plans from elsewhere as worlds."""

from sim2d.importers.import_world import import_file, import_world, open_world

__all__ = ["import_file", "import_world", "open_world"]
