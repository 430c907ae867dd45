// The worlds that have been saved, in the dialog that opens files: to open, to delete, and to bring back; and the dialog that begins a
// new, empty one.

import { $, find, icon, labelled, make } from "../ui/elements.js";
import { post, worlds } from "../net/post.js";
import { toast } from "../ui/words.js";

/** The first of my-world, my-world-2, ... that no world has. @param {WorldTitles} taken */
export function freeName({ yours, ours }) {
  let k = 1;
  const name = () => (k > 1 ? `my-world-${k}` : "my-world");
  while (name() in yours || name() in ours) k += 1;
  return name();
}

/** The dialog that begins a new, empty world. */
export class NewWorld {
  /**
   * @param {() => boolean} isSaved whether nothing would be lost
   * @param {() => void} begun called when the robot is in the new world
   */
  constructor(isSaved, begun) {
    this.isSaved = isSaved;
    this.begun = begun;
    $("new-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.begin();
    });
    $("new-close").addEventListener("click", () => $("new-dialog").close());
  }

  async ask() {
    $("new-name").value = freeName(await worlds());
    $("new-title").value = "";
    $("new-wrong").hidden = true;
    $("new-unsaved").hidden = this.isSaved();
    $("new-dialog").showModal();
    $("new-name").select();
  }

  async begin() {
    const reply = await post("/api/worlds/new", {
      name: $("new-name").value.trim(),
      title: $("new-title").value.trim() || null,
      width_m: Number($("new-width").value),
      depth_m: Number($("new-depth").value),
    });
    $("new-wrong").hidden = !reply.wrong;
    $("new-wrong").textContent = reply.wrong ?? "";
    if (reply.wrong) return;
    $("new-dialog").close();
    toast(`${reply.title}: an empty room of ${reply.size_m.join(" × ")} m. The robot starts in it.`);
    this.begun();
  }
}

/** The saved worlds: to open, to delete, and to bring back. */
export class OwnWorlds {
  /**
   * @param {() => string | undefined} now the name of the world that is open
   * @param {(name: string, title: string) => void} open begins in another one
   */
  constructor(now, open) {
    this.now = now;
    this.open = open;
    this.list = $("own-list");
  }

  async show() {
    for (const part of [$("own"), $("own-wrong")]) part.hidden = true; // what was listed before may be out of date
    this.list.replaceChildren();
    const { yours } = await worlds();
    $("own").hidden = !Object.keys(yours).length;
    this.list.replaceChildren(...Object.entries(yours).map(([name, title]) => this.row(name, title)));
  }

  /** @param {string} name @param {string} title */
  row(name, title) {
    const row = make(
      "li",
      {},
      make("span", {}, make("b", { textContent: title }), make("small", { textContent: name })),
    );
    const open = make("button", { type: "button", textContent: "Open", ariaLabel: `Open ${title}` });
    open.addEventListener("click", () => this.open(name, title));
    const gone = labelled(`Delete ${title}`, make("button", { type: "button", className: "square" }, icon("delete")));
    gone.addEventListener("click", async () => (await this.agrees(name, title)) && this.remove(row, name, title));
    row.append(this.now() === name ? make("em", { textContent: "open now" }) : open, gone);
    return row;
  }

  /** @param {string} name @param {string} title @returns {Promise<boolean>} */
  agrees(name, title) {
    const dialog = $("delete-dialog");
    $("delete-title").textContent = `Delete “${title}”?`;
    $("delete-open").hidden = this.now() !== name;
    dialog.returnValue = "keep";
    dialog.showModal();
    return new Promise((resolve) =>
      dialog.addEventListener("close", () => resolve(dialog.returnValue === "delete"), { once: true }),
    );
  }

  /** @param {HTMLElement} row @param {string} name @param {string} title */
  async remove(row, name, title) {
    if (this.fails(await post("/api/worlds/delete", { name }))) return;
    const undo = make("button", { type: "button", textContent: "Undo", ariaLabel: `Bring ${title} back` });
    const words = make("span", {}, make("span", { textContent: `“${title}” is deleted.` }));
    words.setAttribute("role", "status");
    undo.addEventListener("click", async () => {
      if (this.fails(await post("/api/worlds/restore", { name }))) return;
      const back = this.row(name, title);
      row.replaceWith(back);
      find(back, "button").focus();
    });
    row.replaceChildren(words, undo);
    undo.focus();
  }

  /** @param {Reply} reply */
  fails({ wrong }) {
    $("own-wrong").hidden = !wrong;
    $("own-wrong").textContent = wrong ?? "";
    return Boolean(wrong);
  }
}
