// Written by `python -m web.shared` from the models in Python: change those and run it again.
export const VIEWS = /** @type {const} */ (["all", "office", "pose", "map"]);
export const TABS = /** @type {const} */ (["Senses", "Memory", "Inspect", "Tick", "Truth", "Office", "Tune"]);
export const THEMES = /** @type {const} */ (["dark", "light"]);
export const LOOKS = /** @type {const} */ (["got", "view", "follow", "camera", "theme", "tabs"]);
export const EVENT_KINDS = /** @type {const} */ (["kidnap", "lost", "believes", "joined", "corrected", "recovered", "snap", "goal", "arrived", "unreachable", "packet", "brain", "office", "parameter", "link", "place", "false", "warning", "fault", "trial", "tagged", "reached", "failed", "closure", "explored", "branch", "recording", "lesson"]);
export const GOAL_STATES = /** @type {const} */ (["tracking", "coasting", "exploring", "arrived", "unreachable"]);
export const OFFICE_LISTS = /** @type {const} */ (["walls", "starts", "places", "doors", "lamps", "boxes", "people", "slow_zones", "script", "daylight"]);
export const ENGINES = /** @type {const} */ (["paper", "paper-2005", "paper-2006", "ours"]);
export const SCRIPT_ACTIONS = /** @type {const} */ (["open_door", "close_door", "lamp_on", "lamp_off", "box_appear", "box_vanish", "people_on", "people_off", "daylight"]);
export const WALL_KINDS = /** @type {const} */ (["wall", "partition", "desk", "door", "window", "screen", "glass"]);
export const ADDITIONS = /** @type {const} */ ([{"name": "image and sonars", "adds": "views are levels in even light together with the sonars' echoes; what tells little is doubted, and nothing is no view", "why": "grey levels change with every lamp, and walls look alike where echoes differ", "live": false}, {"name": "waiting time of new views", "adds": "a new view injects nothing for some seconds", "why": "otherwise it would hold the packet back where it has just been learnt", "live": true}, {"name": "heading from the shift", "adds": "the shift of the matched image gives the robot's heading relative to the stored view", "why": "closures need it: the heading of the pose cells is precise to some degrees only", "live": true}, {"name": "best observation", "adds": "a transition is measured where the robot comes nearest to the experience", "why": "the robot enters a zone at its edge, half a metre from where the experience was made", "live": true}, {"name": "scan matching", "adds": "the sonars measure where the robot is to an old place, and whether it is there, and close loops", "why": "a view is much the same a metre aside, in a hall for metres, and is known from one side only", "live": false}, {"name": "uncertain looks", "adds": "an observation is weighed against odometry, and a passage in map correction, by how precisely it is known", "why": "observations are imprecise, odometry over one step is not; taken as they are, the estimate swerves and the map bends", "live": true}, {"name": "robust closures", "adds": "outliers, which the map contradicts, weigh less in its correction; closures that no map brings together are given up", "why": "false loop closures must not bend the whole map", "live": true}, {"name": "odometry edges", "adds": "odometry alone ties experiences made one after the other, even when known ones lie between", "why": "observations, averaged into the rigid chain of odometry or interrupting it, bend and shrink the map", "live": false}, {"name": "exact solver", "adds": "the fixed point of the sweeps is computed directly from time to time; sweeps go by experience", "why": "sweeps alone lag behind a growing map", "live": false}, {"name": "yaw bias", "adds": "the bias of the yaw rate is learnt from what the map cannot explain, held against how large it may be", "why": "it is the largest error of odometry, and closed loops reveal it", "live": true}, {"name": "law of evidence", "adds": "what is seen where the robot cannot be is weighed; a robot that was carried maps a submap, merged at odds of 1000 to 1", "why": "perceptual aliasing, believed at once, makes false loop closures between places far apart", "live": true}, {"name": "kidnap detector", "adds": "a jump of image and sonars that driving cannot explain counts as a kidnap", "why": "otherwise the way the robot was carried becomes a link and bends the map", "live": false}, {"name": "pace floor", "adds": "a link takes at least as long as its length in the map at the robot's average pace", "why": "a route over many short links would promise to arrive in half the time", "live": true}, {"name": "familiar ground", "adds": "where enough of the observations are recognised, no more views, experiences and links are learnt", "why": "otherwise the memory grows for as long as the robot drives, in a place that never changes", "live": false}, {"name": "bounded links of a view", "adds": "a view keeps only its strongest links to pose cells", "why": "it is linked to every cell that was ever active while it was seen, and these links fill most of the memory", "live": true}, {"name": "sparse links of the goal memory", "adds": "cells above half of the peak are linked, once every half metre, and not across jumps", "why": "at 10 Hz a packet is wider than its movement in a tick, so link times would not depend on speed", "live": true}]);
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
