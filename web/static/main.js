// The page: puts the parts together and turns clicks and keys into commands. The server is the only truth.

import { $, find } from "./ui/elements.js";
import { BesideStrip } from "./viewer/beside.js";
import { FirstMinuteCard, Help } from "./header/help.js";
import { HandDrive, actOf, Keys } from "./ui/keys.js";
import { Aids, Presenter } from "./viewer/aids.js";
import { Editor } from "./editor/editor.js";
import { Exports, Keeping } from "./share/keeping.js";
import { Files, Source } from "./worlds/files.js";
import { Gallery, Watched } from "./experiments/gallery.js";
import { KeptBrain, takeBrainFiles } from "./worlds/kept_brain.js";
import { closeOpenMenu, Header, Theming } from "./header/header.js";
import { Levels } from "./ui/levels.js";
import { Lesson } from "./lessons/lesson.js";
import { LessonList } from "./lessons/list.js";
import { Connection, WATCHER_KEYS, newId, onlyLook, takeNoFiles } from "./net/connection.js";
import { dismissToast, sentence, toast } from "./ui/words.js";
import { NewWorld, OwnWorlds } from "./worlds/own_worlds.js";
import { VIEWS } from "./shared.js";
import { PlaceList, Speaker } from "./ui/access.js";
import { Panel } from "./panel/panel.js";
import { RunUntilMenu } from "./timeline/tools.js";
import { Viewer } from "./viewer/viewer.js";
import { Timeline } from "./timeline/timeline.js";

const watching = document.body.dataset.watch === "true";
const page = newId(watching);
if (watching) onlyLook(page);
const link = new Connection(page);
const header = new Header();
const timeline = new Timeline(link);
const drive = new HandDrive((command) => source.lacks === null && link.send(command));
const keys = new Keys({ drive: (name, down) => drive.key(name, down), act, allUp: () => drive.allUp() });
const viewer = new Viewer(link, keys);
const aids = new Aids(link, viewer, (wish, done) => command(wish, done));
const levels = new Levels(watching);
const panel = new Panel($("panel"), link, (text) => toast(text, { bad: true }), levels);
const source = new Source(panel);
/** @type {State | null} */
let state = null;
/** @type {OfficeFields | null} */
let office = null;
const isSaved = () => office?.saved ?? true;
const own = new OwnWorlds(
  () => state?.world ?? undefined,
  async (name, title) => {
    if (await command({ type: "reset", world: name }, `Started anew in ${title}.`)) $("open-dialog").close();
  },
);
const files = new Files(isSaved, own);
const fresh = new NewWorld(isSaved, () => editor.toggle(true));
const editor = new Editor(link, { open: () => files.open(), begin: () => fresh.ask() });
const exports = new Exports(() => timeline.time?.loop ?? null);
const theme = new Theming(link);
const help = new Help();
const first = new FirstMinuteCard(link, (event) => panel.why(event));
const speaker = new Speaker();
const presenter = new Presenter(viewer, panel, link);
const places = new PlaceList(command, () => panel.open("Inspect"));
const kept = new KeptBrain(async (world) => world === state?.world || mayLeave());
const gallery = new Gallery(link, mayLeave);
const lessons = new LessonList(link, mayLeave);
const lesson = new Lesson(link, lessons, { viewer, panel, timeline });
const runUntil = new RunUntilMenu(command, () => first.finds);
const beside = new BesideStrip(command);
const watched = new Watched({
  here: () => command({ type: "resume" }),
  again: (wish) => command(wish),
  more: (trial) => gallery.open(trial),
});
let ownView = viewer.view; // as the run was left: a lesson turns to its own
let away = false; // whether a run waits
let returning = false; // to it: until a state tells so a lesson may still turn to its own view
const goBack = /** @type {HTMLButtonElement[]} */ ([...document.querySelectorAll(".go-back")]);
for (const button of goBack)
  button.addEventListener("click", async () => {
    if (returning) return;
    returning = true;
    if (!(await command({ type: "go_back" }, "Your run goes on from where it was."))) returning = false;
  });
if (!watching) takeBrainFiles();
const keeping = new Keeping(link, { viewer, panel, files, timeline, mayLeave });
viewer.addEventListener(
  "chosen",
  (event) => void panel.awaits(/** @type {CustomEvent<Promise<Answer>>} */ (event).detail),
);
viewer.addEventListener("inside", () => {
  const inside = viewer.frame.contentWindow;
  if (inside) watching ? takeNoFiles(inside) : files.catchDrops(inside);
});
viewer.addEventListener("slow", () =>
  first.afterwards(() => toast("No graphics card in use: the plates move slowly.", { notice: true })),
);

// ---------------------------------------------------------------- what arrives

link.on("state", (/** @type {{ state: State, page: PageFields }} */ detail) => {
  state = detail.state;
  if (gallery.doing) gallery.waking("");
  source.show(detail.page.recording);
  header.show(state, detail.page);
  watched.show(state, detail.page);
  for (const button of goBack) button.hidden = !detail.page.back;
  if (detail.page.back && !away) ownView = viewer.view; // a run that stands still sends nothing, so not before
  away = Boolean(detail.page.back);
  aids.show(detail.page);
  panel.inspected(detail.page.inspected);
  timeline.at(state, detail.page.time);
  lesson.at(state);
  if (returning && !away) {
    returning = false;
    viewer.show(ownView);
  }
  runUntil.at(state, detail.page.places);
  beside.show(state.beside, detail.page.pairs, detail.page.additions_off);
  first.at(state, detail.page);
  office = detail.page.office;
  if (source.lacks && editor.open) editor.toggle(false);
  editor.at(state, detail.page);
  keeping.show(state, detail.page);
  if (!watching) kept.ask();
  document.body.dataset.alive = "true";
});
link.on("waking", (/** @type {{ doing: string }} */ { doing }) => {
  header.waking(doing);
  gallery.waking(doing);
});
link.on("events", (/** @type {{ fresh: boolean, events: TimelineEvent[] }} */ detail) => {
  timeline.add(detail);
  if (!detail.fresh) {
    speaker.onEvents(detail.events);
    first.onEvents(detail.events);
  }
  const told = detail.fresh || first.searches ? ["warning"] : ["warning", "unreachable"];
  for (const event of detail.events.slice(-20))
    if (told.includes(event.kind)) toast(sentence(event.text), { bad: true });
});
link.on("refused", (/** @type {Answer} */ { detail }) => {
  for (const wrong of detail) toast(sentence(wrong.reason), { bad: true });
});

link.on("notice", (/** @type {{ text: string }} */ { text }) => toast(sentence(text), { bad: true }));

/** @type {HTMLElement | null} */
let lostToast = null;
link.addEventListener("lost", () => {
  drive.allUp();
  lostToast ??= toast("Connection lost. Trying again.", { bad: true, stays: true });
});
link.addEventListener("hello", () => {
  theme.tell();
  if (!lostToast) return;
  lostToast.remove();
  lostToast = null;
  toast("Connected again.");
});

// ---------------------------------------------------------------- what is done

/** @param {Command} wish @param {string} [done] */
async function command(wish, done) {
  const answer = await link.ask(wish);
  if (answer.accepted && done) toast(done);
  return answer.accepted;
}

const playOrPause = () => state && command({ type: state.running ? "pause" : "resume" });
const oneTick = () => command({ type: "step", ticks: 1 });
const oneStage = (back = false) => command({ type: "step_stage", back });
const explore = () => command({ type: "set_mode", mode: "explore" }, "Exploring by itself.");
const kidnap = () => command({ type: "kidnap" }, "Moved to a random place. The robot was not told.");
const cancelGoal = () => command({ type: "cancel_goal" });
const restart = (/** @type {number} */ seed) => {
  $("restart").open = false;
  command({ type: "reset", seed }, `Started anew with seed ${seed}.`);
};

on("play", playOrPause);
on("walk-next", () => oneStage());
on("walk-back", () => oneStage(true));
on("walk-end", () => command({ type: "resume" }));
on("explore", explore);
on("kidnap", kidnap);
on("kidnap-phone", kidnap);
on("cancel", cancelGoal);
on("theme", () => theme.toggle());
on("help", () => help.toggle());
on("places", () => places.open(false));
on("present", () => presenter.turn(!presenter.on));
on("lessons", () => lessons.open());
on("experiments", () => gallery.open());
on("lessons-experiments", () => {
  lessons.dialog.close();
  gallery.open();
});
on("restart-same", () => state && restart(state.seed));
on("restart-new", () => restart(crypto.getRandomValues(new Uint16Array(1))[0] % 10000));
on("brain-save", () => {
  $("restart").open = false;
});
on("export", () => {
  $("restart").open = false;
  exports.open();
});
on("open-world", () => {
  $("restart").open = false;
  files.open();
});
on("new-world", () => {
  $("restart").open = false;
  fresh.ask();
});
on("panels", () => panel.show(!panel.shown));
on("panel-show", () => panel.show(true));
on("more", () => {
  const open = find(document, "header").classList.toggle("open");
  $("more").setAttribute("aria-expanded", String(open));
});
$("speed").addEventListener("change", () => {
  command({ type: "set_speed", factor: Number($("speed").value) });
  $("speed").blur();
});
$("world").addEventListener("change", async () => {
  const target = $("world");
  const [world, title] = [target.value, target.selectedOptions[0].text];
  if (!world) return;
  target.blur(); // the list shows the current world again until there is another
  if (await mayLeave()) command({ type: "reset", world }, `Started anew in ${title}.`);
});

/** Whether unsaved changes may be lost. @returns {Promise<boolean>} */
async function mayLeave() {
  if (isSaved()) return true;
  const dialog = $("leave-dialog");
  dialog.returnValue = "stay";
  dialog.showModal();
  return new Promise((resolve) =>
    dialog.addEventListener("close", () => resolve(dialog.returnValue === "leave"), { once: true }),
  );
}
/** What the keys of keys.js do; false: it had no meaning now. @type {Record<import("./ui/keys.js").Act, () => unknown>} */
const ACTS = {
  explore,
  kidnap,
  places: () => places.open(true),
  cancel: () => (state?.goal ? cancelGoal() : false),
  play: playOrPause,
  tick: () => (presenter.on ? false : oneTick()), // a clicker's keys for a black screen
  stage: () => oneStage(),
  tickBack: () => (presenter.on ? false : timeline.tools.tick(-1)),
  secondBack: () => timeline.tools.tick(-10),
  secondOn: () => timeline.tools.tick(10),
  eventBack: () => timeline.tools.event(-1),
  eventOn: () => timeline.tools.event(1),
  now: () => timeline.tools.now(),
  events: () => timeline.list.toggle(),
  goOn: () => ($("go-on").hidden ? false : $("go-on").click()),
  view1: () => viewer.show(VIEWS[0]),
  view2: () => viewer.show(VIEWS[1]),
  view3: () => viewer.show(VIEWS[2]),
  view4: () => viewer.show(VIEWS[3]),
  panel: () => panel.show(!panel.shown),
  theme: () => theme.toggle(),
  present: () => presenter.turn(!presenter.on),
  spotlight: () => (presenter.on ? presenter.light(!presenter.lit) : false),
  next: () => presenter.go(1),
  back: () => presenter.go(-1),
  lessons: () => lessons.open(),
  gallery: () => gallery.open(),
  edit: () => (source.lacks ? toast(source.lacks, { bad: true }) : editor.toggle()),
  help: () => help.toggle(),
  escape: () =>
    closeOpenMenu() || timeline.list.close() || runUntil.close() || dismissToast() || (presenter.on && endPresenting()),
  bookmark: () => timeline.bookmarks.put(),
  follow: () => aids.follow(!aids.following),
  vision: () => aids.see(!aids.seeing),
  replay: () => aids.replay(),
};

function endPresenting() {
  presenter.turn(false);
  return true;
}

/** True when the key had a meaning. @param {string} key */
function act(key) {
  const name = actOf(key);
  return name !== undefined && (!watching || WATCHER_KEYS.has(name)) && ACTS[name]() !== false;
}

/** @param {keyof IndexIds} id @param {() => void} action */
function on(id, action) {
  $(id).addEventListener("click", (event) => {
    action();
    if (/** @type {MouseEvent} */ (event).detail > 0) $(id).blur(); // after a mouse click, the space bar plays and pauses again
  });
}
