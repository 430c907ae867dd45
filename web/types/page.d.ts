// The shapes of what the page holds and is sent, beside those that are written from the models in Python (shared.d.ts).

type Point = [number, number];
type Pose = { x: number; y: number; heading_rad: number };
type World = WorldFile;
type Wall = WallItem;
type Door = DoorItem;

// The things that a pointer can take hold of: all lists of a world but those of time.
type ThingList = Exclude<keyof Things, "script" | "daylight">;
type Field = {
  key: string;
  title: string;
  type: "number" | "text" | "checkbox" | "color" | "select";
  low?: number;
  high?: number;
  of?: readonly string[];
};
type Kind<T> = {
  one: string;
  grips(item: T): Point[];
  far(item: T, p: Point): number;
  shift(item: T, d: Point): T;
  pull(item: T, grip: number, p: Point): T;
  fields: Field[];
};
type Place = { list: ThingList; number: number };
type SetStatus = (text: string, bad: boolean) => void;

type ToolName = "select" | "wall" | "door" | "lamp" | "box" | "person" | "zone" | "start" | "place" | "delete";
type WallLooks = { kind: Wall["kind"]; height: number };
type Tool = {
  title: string;
  key: string;
  says: string[];
  takes?: number; // points; Infinity: until Enter, with `least`
  least?: number;
  chain?: boolean; // the last point begins the next
  list?: ThingList;
  makes?(points: Point[], world: World, looks: WallLooks): EditStep[] | string;
};

// ---------------------------------------------------------------- what the server sends

type GoalState = (typeof import("../static/shared.js").GOAL_STATES)[number];
type EventKind = (typeof import("../static/shared.js").EVENT_KINDS)[number];
type Theme = (typeof import("../static/shared.js").THEMES)[number];
type ViewName = (typeof import("../static/shared.js").VIEWS)[number];
type Goal = { experience: number; x: number; y: number; state: GoalState; eta_s: number | null; remaining_m: number | null };
type Living = { doors: Record<string, number>; lamps: Record<string, boolean>; people: number; boxes: number; daylight: number };
type State = {
  tick: number;
  time_s: number;
  mode: SetMode["mode"] | "recorded";
  running: boolean;
  speed: number;
  world: string | null; // null: a recording plays
  seed: number;
  robot: Pose | null; // null: its true place is unknown
  estimate: Pose;
  pose_cells: { shape: number[]; packets: (Pose & { mass: number })[] };
  goal: Goal | null;
  living: Living | null;
  trial: Trial | null;
  lesson: LessonView | null;
  until: UntilView | null;
  beside: BesideFields | null;
};
type LessonMark = {
  plate: "office" | "map" | "cells";
  x: number;
  y: number;
  heading_rad: number | null;
  words: string;
  tick: number;
  start?: [number, number, number] | null; // among the pose cells
};
type LessonView = {
  name: string;
  title: string;
  state: "scene" | "predict" | "showing" | "compared" | "sandbox";
  doing: string;
  progress: number | null;
  round: number;
  rounds: number;
  label: string;
  seed: number;
  prediction: { choice: number | null; x: number | null; y: number | null } | null;
  votes: { counts: number[]; points: Point[] };
  outcome: {
    words: string;
    because: string;
    right: boolean | null;
    choice: number | null;
    x: number | null;
    y: number | null;
    distance_m: number | null;
  } | null;
  marks: LessonMark[];
  altered: boolean;
  draws: "office" | "map" | null;
};
type UntilView = { what: string; words: string; state: "running" | "met" | "too late" | "broken off"; progress: number };
type LessonCard = {
  name: string;
  number: number;
  title: string;
  idea: string;
  paper: string;
  minutes: number;
  rounds: number;
  own: boolean;
  wrong: string | null;
};
type SymbolText = { mathml: string; means: string; parameter: string | null; value: string | null };
type FormulaText = { mathml: string; latex: string; says: string; source: string; symbols: SymbolText[] };
type LessonText = {
  card: LessonCard;
  text: string;
  more: string | null;
  formulas: FormulaText[];
  world: string;
  engine: string;
  seed: number;
  view: ViewName;
  tab: string;
  labels: string[];
  predict: { question: string; options: string[]; draw: "the robot" | "the belief" | null; plate: "office" | "map" };
  watch: { at: string; words: string }[];
  explains: boolean;
  sandbox: { words: string; button: string | null; commands: Command[] }[];
};
type TrialState = "running" | "over" | "ended";
type Trial = {
  experiment: string;
  title: string;
  engine: EngineName;
  levels: string[];
  seed: number;
  id: string;
  state: TrialState;
  doing: string;
  about_s: number;
  ahead: number | null;
  altered: boolean;
  outcome: string;
};
type Moving = { walkers: Record<string, [number, number, number]>; boxes: string[] };
type Walk = { at: number; of: number; title: string; words: string };
type OfficeFields = { edition: number; undo: string | null; redo: string | null; saved: boolean };
type RecordingFields = { name: string; format: string; moments: number; seconds: number; has: string[]; over: boolean };
// web/messages/robot_status.py
type Chip = { icon: string; tone: string; words: string };
type GoalChip = { icon: string; words: string; short: string; metres: string; seconds: string };
type PageFields = {
  run: number;
  doing: string;
  status: { robot: Chip; goal: GoalChip | null };
  fault: string | null;
  real_time_factor: number;
  title: string;
  worlds: [string, string][];
  places: [string, number, number][];
  recording: RecordingFields | null;
  office: OfficeFields | null;
  inspected: string | null;
  walk: Walk | null;
  moving: Moving | null;
  time: TimeFields | null;
  vision: boolean;
  closure: { event: number; time_s: number; moved_m: number } | null;
  situation: SituationFields | null;
  back: boolean;
  pairs: PairChoice[];
  additions_off: AdditionsOff;
};
/** By name: if the run began again, and as it is. */
type AdditionsOff = { beginning: string[]; now: string[] };
type PairChoice = { name: string; title: string; about: string; since: "beginning" | "now" };
type BrainFields = {
  name: string;
  views: number;
  experiences: number;
  links: number;
  relocalisations: number;
  error_map_m: number | null;
  off_m: number | null;
  lost: boolean;
};
type DifferenceFields = { kind: "packet" | "view" | "experience" | "link"; tick: number; time_s: number; words: string };
type Value = number | boolean | string;
type ChangedField = { name: string; first: Value; second: Value };
type BesideFields = {
  first: BrainFields;
  second: BrainFields;
  since_s: number;
  error_odometry_m: number | null;
  estimate: { x: number; y: number; heading_rad: number };
  differences: DifferenceFields[];
  changed: ChangedField[];
};
type CameraAt = { position: number[]; look_at: number[]; fov_rad: number };
type Look = { plate: ViewName; tab: string | null; camera: CameraAt | null };
type SituationFields = {
  state: "playing" | "same" | "other" | "stopped";
  tick: number;
  end_tick: number;
  words: string;
  state_hash: string;
  look: Look;
};
// What the server makes of the moment that is shown. `link`: null where `why` says that it fits into none.
type Moment = {
  link: string | null;
  why: string;
  name: string;
  file: string;
  python: string;
  tick: number;
  time_s: number;
  state_hash: string;
  orders: number;
};
type BranchFields = { number: number; parent: number | null; from_s: number; end_s: number };
type TimeFields = {
  past: boolean;
  end_tick: number;
  end_s: number;
  begin_s: number;
  branch: number;
  branches: BranchFields[];
  loop: [number, number] | null;
  sides: SideFields[];
  differs: string;
  doing: string;
  done: number;
  bookmarks: Bookmark[];
};
type Bookmark = { tick: number; time_s: number; name: string };
type SideFields = {
  number: number;
  time_s: number;
  error_m: { map: number | null; odometry: number | null }; // of a recording without truth: null
  views: number;
  experiences: number;
  links: number;
  packet: Pose & { mass: number };
  xy: number[][];
  robot: Pose;
  turn_rad: number;
};
// `line`: the name of what repeats; the newest event of a line stands for `count` of them since `since_s`.
type TimelineEvent = { number: number; time_s: number; kind: string; text: string; line: string; count: number; since_s: number };
type Wrong = { field: string | null; value: unknown; reason: string };
// `wrong`: sentences, where something was.
type Reply = { [key: string]: any; wrong?: string; field?: string | null };
type Answer = { accepted: boolean; detail: Wrong[]; id?: number; tick?: number };
type KeptOffer = { world: string; title: string; experiences: number; time_s: number; kept_at: number; run: string | null };
type EngineName = (typeof import("../static/shared.js").ENGINES)[number];
type Axis = { name: string; levels: string[] };
type PlanDrawing = { width: number; depth: number; left: number; bottom: number; walls: string; way: string; places: Point[] };
type Card = {
  name: string;
  title: string;
  paper: string;
  asks: string;
  found: string;
  world: string;
  engines: EngineName[];
  axes: Axis[];
  watch: string[];
  seed: number;
  trials: number;
  seconds: number;
  done: number;
  picture: string | null;
  plan: PlanDrawing | null;
};
type Dot = {
  id: string;
  seed: number;
  quick: boolean;
  good: number | null;
  of: number | null;
  words: string;
  moment_s: number;
  moment: string;
};
type Cell = { engine: EngineName; levels: string[]; n: number; words: string; shade: number | null; dots: Dot[] };
type Results = { score: string; is_rate: boolean; note: string; cells: Cell[] };
type ExperimentDetail = { card: Card; results: Results };
type WorldTitles = { yours: Record<string, string>; ours: Record<string, string> };

type Drawn = { view: ViewName; aspect: number }; // the drawing that was clicked; null: viser's picture
// What concerns one page alone.
type PageMessage =
  | { type: "got" }
  | { type: "view"; name: ViewName }
  | { type: "click"; at: Point; shift: boolean; drawn: Drawn | null }
  | { type: "follow"; on: boolean }
  | { type: "replay"; event: number }
  | { type: "camera"; name: ViewName; at: CameraAt }
  | { type: "theme"; name: Theme; still: boolean }
  | { type: "hover"; at: Point }
  | { type: "tabs"; names: string[] }
  | { type: "present"; on: boolean } // for those who look on
  | { type: "switch"; name: string; on: boolean }; // for all who look
