"""The disk for all rooms: states as arrays and JSON, files that are written whole or not at all, and the folder for them."""

from disk.kept import kept_folder
from disk.kinds import kind
from disk.state_codec import State, encode, write_state
from disk.state_copy import copy_state
from disk.state_reading import decode, read_state
from disk.whole_file import require_writable, sweep, whole_file, write_whole

__all__ = [
    "State",
    "copy_state",
    "decode",
    "encode",
    "kept_folder",
    "kind",
    "read_state",
    "require_writable",
    "sweep",
    "whole_file",
    "write_state",
    "write_whole",
]
