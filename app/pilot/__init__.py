"""The pilot: it explores, avoids obstacles, follows routes, obeys the hand and gets free when stuck."""

# pyright: basic
import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
