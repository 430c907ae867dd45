// Files dropped on the page or chosen: worlds and floor plans. The server says what is wrong with one.

import { $ } from "../ui/elements.js";
import { chosen, dropped, isRecording, play, playFolder } from "./recordings.js";
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

  /** A folder is a recording. @param {() => Promise<import("./recordings.js").Folder>} read @param {number} count of what was dropped */
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
    const tell = () => {
      const seconds = Math.round((performance.now() - began) / 1000);
      $("open-doing").textContent = `Making a world of ${names}${seconds ? `, ${seconds} s` : ""} …`;
    };
    this.say("busy");
    tell();
    const timer = setInterval(tell, 1000);
    try {
      const parts = await Promise.all(files.map(async (file) => ({ name: file.name, data: await base64(file) })));
      const answer = await fetch("/api/worlds/open", {
        method: "POST",
        headers: { "Content-Type": "application/json" },
        body: JSON.stringify({ files: parts, scale_m: scale }),
      });
      const told = await answer.json();
      if (answer.ok) {
        this.dialog.close();
        const size = told.size_m.map(metres).join(" × ");
        toast(`${told.name}: ${told.walls.toLocaleString("en")} walls, ${size} m. The robot starts in it.`);
        for (const sentence of told.said) toast(ended(sentence));
      } else this.fail(told.detail.map((/** @type {Wrong} */ wrong) => ended(wrong.reason)).join(" "), scale !== null);
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
