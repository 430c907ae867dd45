// The menu beside the views: what can be kept of the moment that is shown, and shared. It also opens what others have shared. The
// plates as they are on the stage become a picture or a film of a stretch of time, made in this browser from viser's canvas.

import { $, find, make } from "../ui/elements.js";
import { download, saveCanvas, savePng, saveSvg, shown } from "./pictures.js";
import { fine, toast } from "../ui/words.js";
import { Opening, Share } from "./share.js";
import { reasons } from "../net/post.js";

/** The run and the moment, for the name of a file. @param {string | null} world @param {number} seed @param {number} time_s */
export function nameOfMoment(world, seed, time_s) {
  const minutes = Math.floor(time_s / 60 + 1e-9);
  const seconds = Math.max(0, time_s - 60 * minutes).toFixed(1);
  const where = (world ?? "recording").replace(/[^A-Za-z0-9]+/g, "-");
  return `${where}-seed${seed}-${minutes}m${seconds.padStart(4, "0")}s`;
}

const TYPES = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm", "video/mp4"]; // as a browser knows them
const FPS = 30;
const BITS = 6_000_000; // a second
const LATELY_S = 10;
const LOOKS = 40; // frames that a picture waits for

/** The plates as they are on the stage: a picture of them, and a film of a stretch of time, made from viser's canvas. */
class StageFilm {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {import("../timeline/timeline.js").Timeline} timeline
   */
  constructor(link, timeline) {
    this.link = link;
    this.timeline = timeline;
    /** @type {{ from: number, to: number, last: number, recorder: MediaRecorder, parts: Blob[], whole: boolean } | null} */
    this.film = null;
    /** @type {HTMLElement | null} */
    this.refused = null; // why the last film was not made
    /** @type {State | null} */
    this.state = null;
    $("film-cancel").addEventListener("click", () => this.end(false));
  }

  /** The one that viser draws on: the largest. */
  get canvas() {
    const all = [...($("stage").contentDocument?.querySelectorAll("canvas") ?? [])];
    const largest = all.sort((a, b) => b.width * b.height - a.width * a.height)[0];
    return largest?.width ? largest : null;
  }

  // What is drawn can be read only until the frame is shown.
  async picture() {
    const [canvas, inside] = [this.canvas, $("stage").contentWindow];
    if (!canvas || !inside) return toast("The stage is not awake yet.", { bad: true });
    const copy = make("canvas", { width: canvas.width, height: canvas.height });
    const pen = copy.getContext("2d", { willReadFrequently: true });
    for (let look = 0; look < LOOKS && pen; look++) {
      await new Promise((resolve) =>
        inside.addEventListener("drawn", () => resolve(pen.drawImage(canvas, 0, 0)), { once: true }),
      );
      if (pen.getImageData(copy.width >> 1, copy.height >> 1, 1, 1).data[3] > 0) return saveCanvas(copy, "stage");
    }
    return toast("The stage has drawn nothing that could be kept; try again.", { bad: true });
  }

  /** Where there is no room for the marks a and b: what led to the moment that is shown. @returns {[number, number] | null} */
  lately() {
    const { time, time_s } = this.timeline;
    if (!time || $("mark-a").checkVisibility() || time_s - time.begin_s < 1) return null;
    return [Math.max(time.begin_s, time_s - LATELY_S), time_s];
  }

  /** Plays the stretch between the marks a and b from its beginning, and records it. */
  async begin() {
    const loop = this.timeline.time?.loop ?? this.lately();
    const type = TYPES.find((name) => window.MediaRecorder?.isTypeSupported(name));
    this.refused?.remove(); // the film is shown in its place, and what it asked for may be there by now
    if (this.film) return this.refuse("A film is being made.");
    if (!loop) return this.refuse("Mark a stretch first, with a and b above the timeline; the film shows it.");
    if (!this.canvas || !type) return this.refuse("This browser cannot make films of the stage.");
    const [from, to] = loop;
    const sought = await this.link.ask({ type: "seek", time_s: from });
    if (!sought.accepted) return;
    const recorder = new MediaRecorder(this.canvas.captureStream(FPS), { mimeType: type, videoBitsPerSecond: BITS });
    const film = { from, to, last: from, recorder, parts: /** @type {Blob[]} */ ([]), whole: false };
    recorder.addEventListener("dataavailable", ({ data }) => film.parts.push(data));
    recorder.addEventListener("stop", () => this.save(film));
    this.film = film;
    this.show();
    recorder.start(1000);
    await this.link.ask({ type: "resume" });
  }

  /** @param {string} words */
  refuse(words) {
    this.refused = toast(words, { bad: true });
  }

  /** The page has been told of a moment. @param {State} state @param {PageFields} page */
  at(state, page) {
    this.state = state;
    const film = this.film;
    if (!film) return;
    const over = state.time_s >= film.to - 0.05 || state.time_s < film.last - 0.05 || !page.time?.past;
    film.last = Math.max(film.last, state.time_s);
    if (over) this.end(true);
    else this.show();
  }

  show() {
    const box = $("film");
    box.hidden = this.film === null;
    if (!this.film) return;
    const { from, to, last } = this.film;
    find(box, ".words").textContent = `${fine(last)}, from ${fine(from)} to ${fine(to)}`;
    /** @type {HTMLProgressElement} */ (find(box, "progress")).value = (last - from) / (to - from);
  }

  /** @param {boolean} whole false: it is given up */
  async end(whole) {
    const film = this.film;
    if (!film) return;
    this.film = null;
    film.whole = whole;
    this.show();
    await this.link.ask({ type: "pause" });
    film.recorder.stop();
    for (const track of film.recorder.stream.getTracks()) track.stop();
    if (!whole) toast("The film was cancelled.");
  }

  /** @param {NonNullable<StageFilm["film"]>} film */
  save({ from, to, parts, recorder, whole }) {
    if (!whole) return;
    const blob = new Blob(parts, { type: recorder.mimeType });
    const ending = recorder.mimeType.startsWith("video/mp4") ? "mp4" : "webm";
    const run = nameOfMoment(this.state?.world ?? null, this.state?.seed ?? 0, from);
    const name = `${run}-to-${nameOfMoment("", 0, to).split("-").at(-1)}.${ending}`;
    download(blob, name);
    toast(blob.size ? `Saved ${name}.` : `Saved ${name}, which is empty: the stage drew nothing.`, { bad: !blob.size });
  }
}

/** The run and the moment that are shown. @param {State} state */
function naming({ world, seed, time_s }) {
  shown.name = nameOfMoment(world, seed, time_s);
  shown.words = `${world ?? "recording"}, seed ${seed}, ${fine(time_s)}`;
}

export class Keeping {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {{ viewer: import("../viewer/viewer.js").Viewer, panel: import("../panel/panel.js").Panel,
   *   files: import("../worlds/files.js").Files, timeline: import("../timeline/timeline.js").Timeline, mayLeave: () => Promise<boolean> }} page
   */
  constructor(link, { viewer, panel, files, timeline, mayLeave }) {
    const share = new Share(() => ({ plate: viewer.view, tab: panel.opened, page: link.page }));
    /** @param {Look} look */
    const look = ({ plate, tab, camera }) => {
      viewer.show(plate, camera);
      if (tab) panel.open(tab);
    };
    this.opening = new Opening(link, { mayLeave, look });
    timeline.bookmarks.share = () => share.link();
    files.taken = (file) => this.opening.offer(file);
    this.film = new StageFilm(link, timeline);
    this.on("keep-stage", () => this.film.picture());
    this.on("keep-film", () => this.film.begin());
    /** @type {NodeListOf<HTMLElement>} */
    const plates = $("keep").querySelectorAll("[data-plate]");
    for (const button of plates) this.does(button, () => savePlate(button.dataset.plate ?? "", button.dataset.kind));
    this.on("keep-link", () => share.link());
    this.on("keep-file", () => share.file());
    this.on("keep-python", () => share.python());
  }

  /** @param {State} state @param {PageFields} page */
  show(state, page) {
    naming(state);
    const second = state.beside?.second.name;
    offer("keep-pose-2", second && `Pose cells: ${second}`);
    offer("keep-map-2", second && `Experience map: ${second}`);
    this.opening.show(page);
    this.film.at(state, page);
  }

  /** @param {keyof IndexIds} id @param {() => unknown} action */
  on(id, action) {
    this.does(/** @type {HTMLElement} */ ($(id)), action);
  }

  /** @param {HTMLElement} button @param {() => unknown} action */
  does(button, action) {
    button.addEventListener("click", () => {
      $("keep").open = false;
      action();
    });
  }
}

/**
 * A plate of the second brain under its name; without one there is none.
 * @param {"keep-pose-2" | "keep-map-2"} id @param {string | undefined} words
 */
function offer(id, words) {
  const row = $(id);
  row.hidden = !words;
  if (!words || row.ariaLabel === words) return;
  row.ariaLabel = find(row, "span").textContent = words;
  for (const button of row.querySelectorAll("button")) button.ariaLabel = `${words} as ${button.textContent}`;
}

/** @param {string} plate @param {string} [kind] */
async function savePlate(plate, kind) {
  const theme = document.documentElement.dataset.theme === "light" ? "light" : "dark";
  try {
    const answer = await fetch(`/api/picture/${plate}?theme=${theme}`);
    const save = kind === "png" ? savePng : saveSvg;
    if (answer.ok) await save(await answer.text(), plate.replace("_", "-"));
    else toast(reasons(await answer.json()), { bad: true });
  } catch {
    toast("The connection is lost; the picture was not made.", { bad: true });
  }
}

/** @typedef {{ format: string, words: string, refusal: string | null }} Offer */

const LOOK_MS = 500;

export class Exports {
  /** @param {() => [number, number] | null} marks the stretch that is marked on the timeline, simulated seconds */
  constructor(marks) {
    this.marks = marks;
    /** @type {AbortController | null} */
    this.writing = null;
    $("export-close").addEventListener("click", () => $("export-dialog").close());
    $("export-cancel").addEventListener("click", () => this.writing?.abort());
  }

  async open() {
    $("export-wrong").hidden = true;
    const marks = this.marks();
    $("export-marks").hidden = marks === null;
    [$("export-from").value, $("export-until").value] = marks?.map((time_s) => time_s.toFixed(1)) ?? ["", ""];
    $("export-dialog").showModal();
    try {
      this.show(await (await fetch("/api/exports")).json());
    } catch {
      this.fails("The connection is lost.");
    }
  }

  /** @param {Offer[]} offers */
  show(offers) {
    $("export-list").replaceChildren(...offers.map((offer) => this.row(offer)));
    if (!offers.length) this.fails("This program has no formats to offer.");
  }

  /** @param {Offer} offer */
  row({ format, words, refusal }) {
    const button = make("button", { type: "button", textContent: words, disabled: refusal !== null });
    button.addEventListener("click", () => this.save(format));
    const row = make("li", {}, button);
    if (refusal) row.append(make("small", { textContent: `Not now: ${refusal}.` }));
    return row;
  }

  // A run that is played again takes a while, so the page says how far it is; the dialog may be closed meanwhile.
  /** @param {string} format */
  async save(format) {
    if (this.writing) return this.fails("Another file is being written; wait until it is there, or cancel it.");
    const query = new URLSearchParams({ to: format, pictures: $("export-pictures").value });
    for (const [name, field] of Object.entries({ from_s: $("export-from"), until_s: $("export-until") })) {
      if (!field.checkValidity()) return this.fails("From and to are seconds from 0 on.");
      if (field.value) query.set(name, field.value);
    }
    this.writing = new AbortController();
    const { signal } = this.writing;
    $("export-wrong").hidden = true;
    $("export-busy").hidden = false;
    $("export-doing").textContent = `Writing ${format}.`;
    const looking = setInterval(() => this.look(), LOOK_MS);
    this.look();
    try {
      const answer = await fetch(`/api/export?${query}`, { signal });
      if (answer.ok) this.download(await answer.blob(), answer.headers.get("Content-Disposition") ?? "", format);
      else this.fails(reasons(await answer.json()));
    } catch {
      if (signal.aborted) toast(`The ${format} was not written.`);
      else this.fails("The connection is lost; the file was not written.");
    }
    clearInterval(looking);
    $("export-busy").hidden = true;
    this.writing = null;
  }

  async look() {
    const bar = /** @type {HTMLProgressElement} */ ($("export-done"));
    const share = await fetch("/api/exports/done").then(
      (answer) => answer.json(),
      () => null,
    );
    if (share) bar.value = share;
    else bar.removeAttribute("value"); // nobody knows yet
  }

  /** @param {Blob} blob @param {string} disposition @param {string} format */
  download(blob, disposition, format) {
    const name = /filename="([^"]+)"/.exec(disposition)?.[1] ?? `run.${format}`;
    download(blob, name);
    $("export-dialog").close();
    toast(`Saved ${name}.`);
  }

  /** @param {string} words */
  fails(words) {
    $("export-wrong").textContent = words;
    $("export-wrong").hidden = false;
    if (!$("export-dialog").open) toast(words, { bad: true });
  }
}
