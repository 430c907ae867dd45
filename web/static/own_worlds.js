// The worlds that have been saved, in the dialog that opens files: to open, to delete, and to bring back.

import { icon } from "./icons.js";
import { labelled, make } from "./elements.js";
import { post, worlds } from "./post.js";

const $ = (id) => document.getElementById(id);

export class OwnWorlds {
  // `now()`: the name of the world that is open; `open(name, title)` begins in another one.
  constructor(now, open) {
    Object.assign(this, { now, open, list: $("own-list") });
  }

  async show() {
    $("own").hidden = $("own-wrong").hidden = true; // what was listed before may be over
    this.list.replaceChildren();
    const { yours } = await worlds();
    $("own").hidden = !Object.keys(yours).length;
    this.list.replaceChildren(...Object.entries(yours).map(([name, title]) => this.row(name, title)));
  }

  row(name, title) {
    const row = make("li", {}, make("span", {}, make("b", { textContent: title }), make("small", { textContent: name })));
    const open = make("button", { type: "button", textContent: "Open", ariaLabel: `Open ${title}` });
    open.addEventListener("click", () => this.open(name, title));
    const gone = labelled(`Delete ${title}`, make("button", { type: "button", className: "square" }, icon("delete")));
    gone.addEventListener("click", async () => (await this.agrees(name, title)) && this.remove(row, name, title));
    row.append(this.now() === name ? make("em", { textContent: "open now" }) : open, gone);
    return row;
  }

  agrees(name, title) {
    const dialog = $("delete-dialog");
    $("delete-title").textContent = `Delete “${title}”?`;
    $("delete-open").hidden = this.now() !== name;
    dialog.returnValue = "keep";
    dialog.showModal();
    return new Promise((resolve) => dialog.addEventListener("close", () => resolve(dialog.returnValue === "delete"), { once: true }));
  }

  async remove(row, name, title) {
    if (this.fails(await post("/api/worlds/delete", { name }))) return;
    const undo = make("button", { type: "button", textContent: "Undo", ariaLabel: `Bring ${title} back` });
    const words = make("span", {}, make("span", { textContent: `“${title}” is deleted.` }));
    words.setAttribute("role", "status");
    undo.addEventListener("click", async () => {
      if (this.fails(await post("/api/worlds/restore", { name }))) return;
      const back = this.row(name, title);
      row.replaceWith(back);
      back.querySelector("button").focus();
    });
    row.replaceChildren(words, undo);
    undo.focus();
  }

  fails({ wrong }) {
    $("own-wrong").hidden = !wrong;
    $("own-wrong").textContent = wrong ?? "";
    return Boolean(wrong);
  }
}
