from .kept import user_folder
from .kinds import kind
from .state_codec import State, encode, write_state
from .state_copy import copy_state
from .state_reading import decode, read_state
from .whole_file import require_writable, sweep, whole_file, write_whole

__all__ = [
    "State",
    "copy_state",
    "decode",
    "encode",
    "kind",
    "read_state",
    "require_writable",
    "sweep",
    "user_folder",
    "whole_file",
    "write_state",
    "write_whole",
]
