// Files dropped on the page or chosen: worlds, floor plans, and recordings of a robot, which play. The server says what is wrong with
// one.

import { $, find } from "../ui/elements.js";
import { ended, megabytes, toast } from "../ui/words.js";

const PICTURE = /\.(pgm|png|bmp|jpe?g|ppm|pbm|webp|tiff?|gif)$/i;
const MOST_BYTES = 16_000_000;
const MOST_FILES = 4;

export class Files {
  /**
   * @param {() => boolean} isSaved whether nothing would be lost by leaving the office as it is now
   * @param {import("./own_worlds.js").OwnWorlds} own the list of saved worlds
   */
  constructor(isSaved, own) {
    this.isSaved = isSaved;
    this.own = own;
    /** @type {File[]} */
    this.files = [];
    /** @type {Point | null} */
    this.size = null; // of the picture, pixels
    this.busy = false;
    /** @type {(file: File) => Promise<boolean>} true: the file was something else, and has been taken */
    this.taken = async () => false;
    this.dialog = $("open-dialog");
    this.catchDrops(window);
    $("open-choose").addEventListener("click", () => $("open-files").click());
    $("open-files").addEventListener("change", () => {
      const input = $("open-files");
      if (input.files?.length) this.offer([...input.files]);
      input.value = "";
    });
    $("open-folder").addEventListener("click", () => $("open-folder-files").click());
    $("open-folder-files").addEventListener("change", () => {
      const input = $("open-folder-files");
      const files = [...(input.files ?? [])];
      input.value = "";
      if (files.length) this.offerFolder(async () => chosen(files));
    });
    $("open-scale").addEventListener("submit", (event) => {
      event.preventDefault();
      this.send(this.files, Number($("scale").value));
    });
    $("scale").addEventListener("input", () => this.showSize());
    $("open-close").addEventListener("click", () => this.dialog.close());
    this.dialog.addEventListener("cancel", (event) => this.busy && event.preventDefault());
    const drop = $("drop");
    drop.addEventListener("dragover", (event) => {
      event.preventDefault();
      if (event.dataTransfer) event.dataTransfer.dropEffect = "copy";
    });
    drop.addEventListener("dragleave", () => {
      drop.hidden = true;
    });
    drop.addEventListener("drop", (event) => {
      event.preventDefault();
      drop.hidden = true;
      if (this.busy) return;
      const entries = [...(event.dataTransfer?.items ?? [])].map((item) => item.webkitGetAsEntry?.());
      const folder = entries.find((entry) => entry?.isDirectory);
      if (folder) this.offerFolder(() => dropped(/** @type {FileSystemDirectoryEntry} */ (folder)), entries.length);
      else this.offer([...(event.dataTransfer?.files ?? [])]);
    });
  }

  /** @param {Window} place */
  // Also in the viewer's frame, which covers most of the page. What follows goes to the sheet that covers all of it.
  catchDrops(place) {
    place.addEventListener("dragenter", (event) => {
      if (![...(event.dataTransfer?.types ?? [])].includes("Files")) return;
      event.preventDefault();
      $("drop").hidden = false;
    });
    for (const kind of /** @type {const} */ (["dragover", "drop"])) // else the browser would leave the page for the file
      place.addEventListener(
        kind,
        (event) => [...(event.dataTransfer?.types ?? [])].includes("Files") && event.preventDefault(),
      );
  }

  // The dialog, to choose a file.
  open() {
    this.say("choose");
    if (this.dialog.open) return;
    this.own.show();
    this.dialog.showModal();
  }

  /** @param {File[]} files */
  async offer(files) {
    this.files = files;
    if (files.length === 1 && (await this.taken(files[0]))) return this.dialog.close();
    this.open();
    if (files.length > MOST_FILES)
      return this.fail(`${files.length} files at once; at most ${MOST_FILES} that belong together.`);
    for (const file of files)
      if (file.size > MOST_BYTES && !isRecording(file))
        return this.fail(`${file.name}: ${megabytes(file.size)}; at most ${megabytes(MOST_BYTES)}.`);
    if (files.length === 1 && isRecording(files[0])) return this.play(files[0]);
    if (files.length > 1 || !PICTURE.test(files[0].name)) return this.send(files, null);
    this.size = null;
    $("open-picture").textContent = files[0].name;
    this.say("scale");
    this.showSize();
    $("scale").select();
    try {
      const picture = await createImageBitmap(files[0]);
      this.size = [picture.width, picture.height];
      picture.close();
    } catch {
      this.size = await portableSize(files[0]); // browsers cannot read the formats that robots write
    }
    this.showSize();
  }

  showSize() {
    const scale = Number($("scale").value);
    $("scale-size").textContent =
      this.size && scale > 0
        ? `${this.size[0]} × ${this.size[1]} pixels: ${metres(this.size[0] * scale)} × ${metres(this.size[1] * scale)} m`
        : "One pixel of most robot maps is 0.05 m.";
  }

  /** A folder is a recording. @param {() => Promise<Folder>} read @param {number} count of what was dropped */
  async offerFolder(read, count = 1) {
    this.files = [];
    this.open();
    if (count > 1) return this.fail("More than one thing beside a folder; drop the folder alone.");
    this.wait("Looking into the folder …");
    try {
      const folder = await read();
      const wrong = await playFolder(folder, (words) => this.wait(words));
      return this.played(folder.name, wrong);
    } catch {
      return this.played("", "The folder cannot be read.");
    }
  }

  /** @param {File} file */
  async play(file) {
    this.wait(`Looking over ${file.name} …`);
    return this.played(file.name, await play(file));
  }

  /** @param {string} words what is being done */
  wait(words) {
    if (!this.busy) this.say("busy");
    this.busy = true;
    $("open-doing").textContent = words;
  }

  /** @param {string} name @param {string} wrong */
  played(name, wrong) {
    this.busy = false;
    if (wrong) return this.fail(wrong);
    this.dialog.close();
    return toast(`${name} plays.`);
  }

  /** @param {File[]} files @param {number | null} scale */
  async send(files, scale) {
    this.busy = true;
    const names = files.map((file) => file.name).join(" and ");
    const began = performance.now();
    const showDoing = () => {
      const seconds = Math.round((performance.now() - began) / 1000);
      $("open-doing").textContent = `Making a world of ${names}${seconds ? `, ${seconds} s` : ""} …`;
    };
    this.say("busy");
    showDoing();
    const timer = setInterval(showDoing, 1000);
    try {
      const parts = await Promise.all(files.map(async (file) => ({ name: file.name, data: await base64(file) })));
      const answer = await fetch("/api/worlds/open", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ files: parts, scale_m: scale }),
      });
      const reply = await answer.json();
      if (answer.ok) {
        this.dialog.close();
        const size = reply.size_m.map(metres).join(" × ");
        toast(`${reply.name}: ${reply.walls.toLocaleString("en")} walls, ${size} m. The robot starts in it.`);
        for (const sentence of reply.said) toast(ended(sentence));
      } else this.fail(reply.detail.map((/** @type {Wrong} */ wrong) => ended(wrong.reason)).join(" "), scale !== null);
    } catch {
      this.fail(`${names} could not be sent.`, scale !== null);
    } finally {
      clearInterval(timer);
      this.busy = false;
    }
  }

  /** @param {string} text */
  fail(text, again = false) {
    this.say(again ? "scale" : "choose");
    $("open-wrong").hidden = false;
    $("open-wrong").textContent = `${text} The robot goes on as before.`;
  }

  /** @param {"choose" | "scale" | "busy"} step */
  say(step) {
    this.dialog.dataset.step = step;
    /** @type {NodeListOf<HTMLElement>} */
    const parts = this.dialog.querySelectorAll("[data-steps]");
    for (const part of parts) part.hidden = !part.dataset.steps?.split(" ").includes(step);
    $("open-wrong").hidden = true;
    $("open-unsaved").hidden = this.isSaved() || step === "busy";
  }
}

/** Width and height of a .pgm, .ppm or .pbm, or null. @param {File} file @returns {Promise<Point | null>} */
async function portableSize(file) {
  const head = (await file.slice(0, 1000).text()).replace(/#.*\n/g, "\n");
  const found = /^P[1-6]\s+(\d+)\s+(\d+)\s/.exec(head);
  return found && [Number(found[1]), Number(found[2])];
}

/** @param {File} file @returns {Promise<string>} */
function base64(file) {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result).split(",")[1]);
    reader.onerror = () => reject(reader.error);
    if (file.size) reader.readAsDataURL(file);
    else resolve("");
  });
}

/** @param {number} value */
const metres = (value) => value.toFixed(1);

const OFFICE_TABS = ["Office"];

/** Where the session comes from: an office that is simulated, or a recording. */
export class Source {
  /** @param {import("../panel/panel.js").Panel} panel */
  constructor(panel) {
    this.panel = panel;
    this.shown = "";
    /** @type {RecordingFields | null} */
    this.recording = null;
  }

  /** @param {RecordingFields | null} recording */
  show(recording) {
    this.recording = recording;
    const truth = recording === null || recording.has.includes("truth");
    const now = `${recording?.name} ${truth}`;
    if (now === this.shown) return;
    this.shown = now;
    document.body.dataset.source = recording ? "recording" : "office";
    document.body.dataset.truth = String(truth);
    find(document, 'button[data-view="office"]').textContent = recording ? "True path" : "Office";
    this.panel.hide([...(recording ? OFFICE_TABS : []), ...(truth ? [] : ["Truth"])]);
    $("restart-words").textContent = recording ? "Play from the beginning with seed" : "Restart with seed";
  }

  /** Why an order to the robot or the office is not carried out, or null. */
  get lacks() {
    return this.recording && "A recording plays: it has no office, and its robot goes where it went.";
  }
}

const RECORDING =
  /\.(mcap|bag|db3|log|clf|carmen|mp4|avi|mkv|mov|webm|m4v|mpe?g|tar|tgz|tbz2?|txz|zip|7z|rar)(\.(gz|bz2|xz|zst))?$/i;
const MOST_RECORDED = 900_000_000;
const AT_ONCE = 4; // files of a folder on their way

/** @typedef {{ name: string, files: { path: string, file: File }[] }} Folder paths are within the folder */

/** @param {File} file */
export const isRecording = ({ name }) => RECORDING.test(name);

/** Sends it. Returns what is wrong, in sentences, or "" when it plays. @param {File} file */
export async function play(file) {
  if (file.size > MOST_RECORDED) return tooLarge(file.name, file.size);
  try {
    return await send("POST", { name: file.name }, file);
  } catch {
    return `${file.name} could not be sent.`;
  }
}

/**
 * Sends the files of a folder, some at once. Returns what is wrong, in sentences, or "" when it plays.
 * @param {Folder} folder
 * @param {(words: string) => void} report how far it is
 */
export async function playFolder({ name, files }, report) {
  const whole = files.reduce((sum, { file }) => sum + file.size, 0);
  if (!files.length) return `${name}: there is no file in this folder.`;
  if (whole > MOST_RECORDED) return tooLarge(name, whole);
  const folder = crypto
    .getRandomValues(new Uint32Array(4))
    .reduce((text, part) => text + part.toString(16).padStart(8, "0"), "");
  const waiting = [...files];
  let [sent, bytes, wrong] = [0, 0, ""];
  const one = async () => {
    for (let next = waiting.shift(); next && !wrong; next = waiting.shift()) {
      const said = await send("PUT", { folder, of: name, name: next.path }, next.file);
      wrong ||= said;
      sent += 1;
      bytes += next.file.size;
      report(
        `Sending ${name}: ${sent.toLocaleString("en")} of ${files.length.toLocaleString("en")} files, ${megabytes(bytes)} of ${megabytes(whole)} …`,
      );
    }
  };
  try {
    await Promise.all(Array.from({ length: AT_ONCE }, one));
    if (wrong) return wrong;
    report(`Looking over ${name} …`);
    return await send("POST", { folder, name }, new Blob());
  } catch {
    return `${name} could not be sent.`;
  }
}

/** All files of a folder that was dropped, with those in its folders. @param {FileSystemDirectoryEntry} entry @returns {Promise<Folder>} */
export async function dropped(entry) {
  /** @type {Folder} */
  const folder = { name: entry.name, files: [] };
  /** @param {FileSystemDirectoryEntry} place @param {string} under */
  const look = async (place, under) => {
    for (const each of await within(place))
      if (each.isDirectory) await look(/** @type {FileSystemDirectoryEntry} */ (each), `${under}${each.name}/`);
      else
        folder.files.push({
          path: under + each.name,
          file: await fileOf(/** @type {FileSystemFileEntry} */ (each)),
        });
  };
  await look(entry, "");
  return folder;
}

/** What is in a folder, without what is hidden. @param {FileSystemDirectoryEntry} place @returns {Promise<FileSystemEntry[]>} */
async function within(place) {
  const reader = place.createReader();
  /** @type {FileSystemEntry[]} */
  const all = [];
  for (;;) {
    /** @type {FileSystemEntry[]} */
    const some = await new Promise((resolve, reject) => reader.readEntries(resolve, reject)); // a hundred at a time
    if (!some.length) return all.filter(({ name }) => !name.startsWith("."));
    all.push(...some);
  }
}

/** @param {FileSystemFileEntry} entry @returns {Promise<File>} */
const fileOf = (entry) => new Promise((resolve, reject) => entry.file(resolve, reject));

/** The folder that was chosen. @param {File[]} files with their paths, which begin with the folder's name @returns {Folder} */
export function chosen(files) {
  const name = files[0].webkitRelativePath.split("/")[0];
  const parts = files.map((file) => ({ path: file.webkitRelativePath.slice(name.length + 1), file }));
  return { name, files: parts.filter(({ path }) => !/(^|\/)\./.test(path)) };
}

/** @param {"POST" | "PUT"} method @param {Record<string, string>} query @param {Blob} body what is wrong, or "" */
async function send(method, query, body) {
  const answer = await fetch(`/api/recordings?${new URLSearchParams(query)}`, {
    method,
    headers: { "Content-Type": "application/octet-stream" },
    body,
  });
  if (answer.ok) return "";
  return (await answer.json()).detail.map((/** @type {Wrong} */ wrong) => ended(wrong.reason)).join(" ");
}

/** @param {string} name @param {number} size */
const tooLarge = (name, size) =>
  `${name}: ${megabytes(size)}; at most ${megabytes(MOST_RECORDED)}. Larger ones play by ratslam run --recording PATH.`;
