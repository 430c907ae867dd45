// The page: puts the parts together and turns clicks and keys into commands. The server is the only truth.

import { $, find } from "./elements/dom.js";
import { HandDrive } from "./driving/drive.js";
import { Editor } from "./editor/editor.js";
import { Exports } from "./export/export.js";
import { Files } from "./worlds/files.js";
import { Gallery } from "./experiments/gallery.js";
import { Header } from "./header/header.js";
import { setIcon } from "./elements/icons.js";
import { KeptBrain } from "./worlds/kept_brain.js";
import { Keys } from "./driving/keys.js";
import { Connection } from "./net/connection.js";
import { closeOpenMenu } from "./header/menus.js";
import { sentence } from "./model/sentences.js";
import { NewWorld } from "./worlds/new_world.js";
import { OwnWorlds } from "./worlds/own_worlds.js";
import { THEMES, VIEWS } from "./shared.js";
import { Panel } from "./panel/panel.js";
import { Source } from "./recordings/source.js";
import { Viewer } from "./viewer/viewer.js";
import { Timeline } from "./timeline/timeline.js";
import { dismissToast, toast } from "./elements/toasts.js";
import { Watched } from "./experiments/watched.js";

const page = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
const link = new Connection(page);
const header = new Header();
const timeline = new Timeline(link);
const drive = new HandDrive((command) => source.lacks === null && link.tell(command));
const keys = new Keys({ drive: (name, down) => drive.key(name, down), act, allUp: () => drive.allUp() });
const viewer = new Viewer(link, keys);
const panel = new Panel($("panel"), link, (text) => toast(text, { bad: true }));
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
const exports = new Exports();
const kept = new KeptBrain(async (world) => world === state?.world || mayLeave());
const gallery = new Gallery(link, mayLeave);
const watched = new Watched({
  here: () => command({ type: "resume" }),
  again: (wish) => command(wish),
  more: () => gallery.open(),
});
viewer.addEventListener("inside", () => viewer.frame.contentWindow && files.catchDrops(viewer.frame.contentWindow));

// ---------------------------------------------------------------- what arrives

link.on("state", (/** @type {{ state: State, page: PageFields }} */ detail) => {
  state = detail.state;
  if (gallery.doing) gallery.waking("");
  source.show(detail.page.recording);
  header.show(state, detail.page);
  watched.show(state, detail.page);
  panel.inspected(detail.page.inspected);
  timeline.at(state, detail.page.time);
  office = detail.page.office;
  if (source.lacks && editor.open) editor.toggle(false);
  editor.at(state, detail.page);
  kept.ask();
  document.body.dataset.alive = "true";
});
link.on("waking", (/** @type {{ doing: string }} */ { doing }) => {
  header.waking(doing);
  gallery.waking(doing);
});
link.on("events", (/** @type {{ fresh: boolean, events: TimelineEvent[] }} */ detail) => {
  timeline.add(detail);
  const told = detail.fresh ? ["warning"] : ["warning", "unreachable"];
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
  link.tell({ type: "theme", name: theme() });
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

/** Uploads a saved brain as it is; the server says in a sentence what is wrong with it. @param {File} file */
async function loadBrain(file) {
  const headers = { "Content-Type": "application/octet-stream" };
  try {
    const answer = await fetch("/api/brain", { method: "POST", headers, body: file });
    const told = await answer.json();
    if (answer.ok) toast(`Started anew with the brain of ${file.name}.`);
    else for (const wrong of told.detail) toast(sentence(wrong.reason), { bad: true });
  } catch {
    toast(`${file.name} could not be sent.`, { bad: true });
  }
}

on("play", playOrPause);
on("step", oneTick);
on("stage-step", () => oneStage());
on("walk-next", () => oneStage());
on("walk-back", () => oneStage(true));
on("walk-end", () => command({ type: "resume" }));
on("explore", explore);
on("kidnap", kidnap);
on("kidnap-phone", kidnap);
on("cancel", cancelGoal);
on("theme", toggleTheme);
on("help", toggleHelp);
on("experiments", () => gallery.open());
on("help-close", toggleHelp);
on("restart-same", () => state && restart(state.seed));
on("restart-new", () => restart(crypto.getRandomValues(new Uint16Array(1))[0] % 10000));
on("brain-save", () => {
  $("restart").open = false;
});
on("brain-load", () => {
  $("restart").open = false;
  $("brain-file").click();
});
$("brain-file").addEventListener("change", () => {
  const input = $("brain-file");
  if (input.files?.length) loadBrain(input.files[0]);
  input.value = ""; // so that the same file can be chosen again
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
$("help-dialog").addEventListener("click", ({ target }) => target === $("help-dialog") && toggleHelp());

/** What the keys do. @type {Record<string, () => unknown>} */
const KEYS = {
  " ": playOrPause,
  ".": oneTick,
  b: () => timeline.tools.tick(-1),
  j: () => timeline.tools.tick(-10),
  l: () => timeline.tools.tick(10),
  "[": () => timeline.tools.event(-1),
  "]": () => timeline.tools.event(1),
  n: () => timeline.tools.now(),
  v: () => timeline.list.toggle(),
  ",": () => oneStage(),
  e: explore,
  k: kidnap,
  t: toggleTheme,
  p: () => panel.show(!panel.shown),
  o: () => (source.lacks ? toast(source.lacks, { bad: true }) : editor.toggle()),
  g: () => gallery.open(),
  "?": toggleHelp,
};

/** True when the key had a meaning. @param {string} name */
function act(name) {
  const view = VIEWS[Number(name) - 1];
  if (view) viewer.show(view);
  else if (name === "x" && state?.goal) cancelGoal();
  else if (Object.hasOwn(KEYS, name)) KEYS[name]();
  else return name === "Escape" && (closeOpenMenu() || timeline.list.close() || dismissToast());
  return true;
}

/** @param {keyof IndexIds} id @param {() => void} action */
function on(id, action) {
  $(id).addEventListener("click", (event) => {
    action();
    if (/** @type {MouseEvent} */ (event).detail > 0) $(id).blur(); // after a mouse click, the space bar plays and pauses again
  });
}

// ---------------------------------------------------------------- looks

/** @returns {Theme} */
function theme() {
  return document.documentElement.dataset.theme === "light" ? "light" : "dark";
}

/** The theme chosen earlier in this browser, else the system's. @returns {Theme} */
function firstTheme() {
  const preferred = window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  try {
    const kept = localStorage.getItem("theme");
    return THEMES.find((name) => name === kept) ?? preferred;
  } catch {
    return preferred; // this browser stores nothing
  }
}

/** The viewer follows: the server shows this page the viewer of its theme. @param {Theme} name */
function showTheme(name) {
  document.documentElement.dataset.theme = name;
  setIcon($("theme"), name === "dark" ? "sun" : "moon");
  $("theme").setAttribute("aria-label", name === "dark" ? "Light colours" : "Dark colours");
  link.tell({ type: "theme", name });
}

function toggleTheme() {
  const other = theme() === "dark" ? "light" : "dark";
  showTheme(other);
  try {
    localStorage.setItem("theme", other);
  } catch {
    // The choice is forgotten with the page.
  }
}

function toggleHelp() {
  if ($("help-dialog").open) $("help-dialog").close();
  else $("help-dialog").showModal();
}

showTheme(firstTheme());
