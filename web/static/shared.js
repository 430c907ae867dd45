// Written by `python -m web.shared` from the models in Python: change those and run it again.
export const VIEWS = /** @type {const} */ (["all", "office", "pose", "map"]);
export const TABS = /** @type {const} */ (["Senses", "Memory", "Inspect", "Tick", "Truth", "Office", "Tune"]);
export const THEMES = /** @type {const} */ (["dark", "light"]);
export const LOOKS = /** @type {const} */ (["got", "view", "follow", "camera", "theme", "tabs"]);
export const EVENT_KINDS = /** @type {const} */ (["kidnap", "lost", "recovered", "snap", "goal", "arrived", "unreachable", "packet", "brain", "office", "parameter", "link", "place", "false", "warning", "fault", "trial", "tagged", "reached", "failed", "closure", "branch", "recording", "lesson"]);
export const GOAL_STATES = /** @type {const} */ (["tracking", "coasting", "exploring", "arrived", "unreachable"]);
export const OFFICE_LISTS = /** @type {const} */ (["walls", "starts", "places", "doors", "lamps", "boxes", "people", "slow_zones", "script", "daylight"]);
export const SCRIPT_ACTIONS = /** @type {const} */ (["open_door", "close_door", "lamp_on", "lamp_off", "box_appear", "box_vanish", "people_on", "people_off", "daylight"]);
export const WALL_KINDS = /** @type {const} */ (["wall", "partition", "desk", "door", "window", "screen", "glass"]);
// The least and the most of each number of the world file, by list and key.
export const LIMITS = {
  "walls": {
    "from": [
      -10000,
      10000
    ],
    "to": [
      -10000,
      10000
    ],
    "height": [
      0,
      20
    ],
    "bottom": [
      0,
      20
    ],
    "reflection": [
      0,
      1
    ]
  },
  "starts": {
    "x": [
      -10000,
      10000
    ],
    "y": [
      -10000,
      10000
    ],
    "heading_deg": [
      -360,
      360
    ]
  },
  "places": {
    "x": [
      -10000,
      10000
    ],
    "y": [
      -10000,
      10000
    ]
  },
  "doors": {
    "hinge": [
      -10000,
      10000
    ],
    "angle_deg": [
      -360,
      360
    ],
    "width": [
      0.3,
      6
    ],
    "height": [
      0,
      20
    ],
    "swing_deg": [
      -175,
      175
    ],
    "period_s": [
      0,
      1000000.0
    ],
    "open_s": [
      0,
      1000000.0
    ],
    "phase_s": [
      0,
      1000000.0
    ]
  },
  "lamps": {
    "x": [
      -10000,
      10000
    ],
    "y": [
      -10000,
      10000
    ],
    "reach": [
      0.5,
      50
    ],
    "brightness": [
      0,
      3
    ]
  },
  "boxes": {
    "x": [
      -10000,
      10000
    ],
    "y": [
      -10000,
      10000
    ],
    "width": [
      0.05,
      20
    ],
    "depth": [
      0.05,
      20
    ],
    "height": [
      0,
      20
    ],
    "angle_deg": [
      -360,
      360
    ]
  },
  "people": {
    "path": [
      -10000,
      10000
    ],
    "speed": [
      0.05,
      2
    ],
    "wait_s": [
      0,
      1000000.0
    ],
    "radius": [
      0.1,
      0.5
    ],
    "height": [
      0.5,
      2.5
    ]
  },
  "slow_zones": {
    "corners": [
      -10000,
      10000
    ],
    "factor": [
      0.05,
      1
    ]
  },
  "script": {
    "at_s": [
      0,
      1000000.0
    ],
    "level": [
      0,
      3
    ]
  },
  "daylight": {
    "repeat_s": [
      0,
      1000000.0
    ]
  }
};
