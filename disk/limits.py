"""How much of everything there may be, in one table: who writes and who reads ask the same numbers."""

LEVELS = 20  # lists, objects and tables within one another, in JSON and TOML
TOML_BYTES = 200_000  # of a lesson, an experiment or a file of parameters

# an experiment
AXES = 8
CELLS = 1_000  # combinations of levels
TRIALS = 100_000  # in all of them, with all engines
TRIAL_S = 1e6  # simulated, eleven days

# a run, on the disk and as a situation
TICKS = 10_000_000  # eleven days
ORDERS = 1_000_000  # a day of steering that changes with every tick
PARTS_OF_AN_ORDER = 8  # commas, lists and objects, on average
EDITED_BYTES = 512 << 20  # of all texts of edited worlds together
RUN_BYTES = 256 << 20  # of its file
LINE_BYTES = 64 << 20  # of a line in it; the longest holds the text of a world
LINE_PARTS = 100_000  # commas, lists and objects of a line, outside of its texts
SITUATION_BYTES = 128 << 20  # of its file, with a brain in base64
LINK_BYTES = 16 << 20  # of a link, unpacked
