"""The disk for all rooms: states as arrays and JSON, files that are written whole or not at all, and the folder for them."""

# pyright: basic
import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
