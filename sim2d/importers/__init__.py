"""Floor plans that others have made, as worlds."""

from sim2d.importers.import_world import import_file, import_world, open_world

__all__ = ["import_file", "import_world", "open_world"]
