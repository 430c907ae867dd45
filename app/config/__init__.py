"""All parameters in one frozen tree, written to and read from TOML, and presets."""

# pyright: basic
import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
