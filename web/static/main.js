// The page: puts the parts together and turns clicks and keys into commands. The server is the only truth.

import { Drive } from "./drive.js";
import { Editor } from "./editor.js";
import { Files, sentence } from "./files.js";
import { Header } from "./header.js";
import { setIcon } from "./icons.js";
import { Keys } from "./keys.js";
import { Link } from "./link.js";
import { closeOpenMenu } from "./menus.js";
import { NewWorld } from "./new_world.js";
import { OwnWorlds } from "./own_worlds.js";
import { Stage, VIEWS } from "./stage.js";
import { Timeline } from "./timeline.js";
import { toast } from "./toasts.js";

const $ = (id) => document.getElementById(id);

const page = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
const link = new Link(page);
const header = new Header();
const timeline = new Timeline();
const drive = new Drive((command) => link.tell(command));
const keys = new Keys({ drive: (name, down) => drive.key(name, down), act, allUp: () => drive.allUp() });
const stage = new Stage(link, keys);
let state = null;
let office = null;
const isSaved = () => office?.saved ?? true;
const own = new OwnWorlds(() => state?.world, async (name, title) => {
  if (await command({ type: "reset", world: name }, `Started anew in ${title}.`)) $("open-dialog").close();
});
const files = new Files(isSaved, own);
const fresh = new NewWorld(isSaved, () => editor.toggle(true));
const editor = new Editor(link, { open: () => files.open(), begin: () => fresh.ask() });
stage.addEventListener("inside", ({ detail }) => files.catchDrops(detail));

// ---------------------------------------------------------------- what arrives

link.addEventListener("state", ({ detail }) => {
  state = detail.state;
  if (detail.theme === null) link.tell({ type: "theme", name: preferredTheme() });
  else showTheme(detail.theme);
  header.show(state, detail.page);
  stage.inspected(detail.page.inspected);
  timeline.at(state.time_s);
  office = detail.page.office;
  editor.at(state, detail.page);
  document.body.dataset.alive = "true";
});
link.addEventListener("events", ({ detail }) => {
  timeline.add(detail);
  for (const event of detail.events.slice(-20)) if (event.kind === "warning") toast(sentence(event.text), { bad: true });
});
link.addEventListener("refused", ({ detail }) => {
  for (const wrong of detail.detail) toast(sentence(wrong.reason), { bad: true });
});

let lostToast = null;
link.addEventListener("lost", () => {
  drive.allUp();
  lostToast ??= toast("Connection lost. Trying again.", { bad: true, stays: true });
});
link.addEventListener("hello", () => {
  if (!lostToast) return;
  lostToast.remove();
  lostToast = null;
  toast("Connected again.");
});

// ---------------------------------------------------------------- what is done

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
const restart = (seed) => {
  $("restart").open = false;
  command({ type: "reset", seed }, `Started anew with seed ${seed}.`);
};

// A saved brain goes up as it is; what is wrong with it comes back as a sentence.
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
on("help-close", toggleHelp);
on("restart-same", () => restart(state.seed));
on("restart-new", () => restart(crypto.getRandomValues(new Uint16Array(1))[0] % 10000));
on("brain-save", () => ($("restart").open = false));
on("brain-load", () => {
  $("restart").open = false;
  $("brain-file").click();
});
$("brain-file").addEventListener("change", ({ target }) => {
  if (target.files.length) loadBrain(target.files[0]);
  target.value = ""; // so that the same file can be chosen again
});
on("open-world", () => {
  $("restart").open = false;
  files.open();
});
on("new-world", () => {
  $("restart").open = false;
  fresh.ask();
});
on("panels", () => stage.showPanels(!stage.panels));
on("more", () => {
  const open = document.querySelector("header").classList.toggle("open");
  $("more").setAttribute("aria-expanded", String(open));
});
$("speed").addEventListener("change", ({ target }) => {
  command({ type: "set_speed", factor: Number(target.value) });
  target.blur();
});
$("world").addEventListener("change", async ({ target }) => {
  const [world, title] = [target.value, target.selectedOptions[0].text];
  target.blur(); // the list shows the present world again until there is another
  if (await mayLeave()) command({ type: "reset", world }, `Started anew in ${title}.`);
});

// Whether what has been drawn and not saved may be left behind.
function mayLeave() {
  if (isSaved()) return true;
  const dialog = $("leave-dialog");
  dialog.returnValue = "stay";
  dialog.showModal();
  return new Promise((resolve) => dialog.addEventListener("close", () => resolve(dialog.returnValue === "leave"), { once: true }));
}
$("help-dialog").addEventListener("click", ({ target }) => target === $("help-dialog") && toggleHelp());

// True when the key meant something.
function act(name) {
  const view = VIEWS[Number(name) - 1];
  if (view) stage.show(view);
  else if (name === " ") playOrPause();
  else if (name === ".") oneTick();
  else if (name === ",") oneStage();
  else if (name === "e") explore();
  else if (name === "k") kidnap();
  else if (name === "x" && state?.goal) cancelGoal();
  else if (name === "t") toggleTheme();
  else if (name === "o") editor.toggle();
  else if (name === "?") toggleHelp();
  else return name === "Escape" && closeOpenMenu();
  return true;
}

function on(id, action) {
  $(id).addEventListener("click", (event) => {
    action();
    if (event.detail > 0) event.currentTarget.blur(); // after a mouse click the space bar is play and pause again
  });
}

// ---------------------------------------------------------------- looks

function preferredTheme() {
  return window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
}

function showTheme(theme) {
  if (document.documentElement.dataset.theme === theme) return;
  document.documentElement.dataset.theme = theme;
  setIcon($("theme"), theme === "dark" ? "sun" : "moon");
  $("theme").setAttribute("aria-label", theme === "dark" ? "Light colours" : "Dark colours");
}

function toggleTheme() {
  link.tell({ type: "theme", name: document.documentElement.dataset.theme === "dark" ? "light" : "dark" });
}

function toggleHelp() {
  if ($("help-dialog").open) $("help-dialog").close();
  else $("help-dialog").showModal();
}

showTheme(preferredTheme());
