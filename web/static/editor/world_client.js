// The office as the engine has it, and the dialog that saves it under a name. It is read again after each change; edits, undo and
// redo go one after the other.

import { sentence, toast } from "../ui/words.js";
import { $ } from "../ui/elements.js";
import { post, worlds } from "../net/post.js";

/** The refusal of an edit without the numbers that things have in the world's file. @param {string} reason */
export const plainly = (reason) =>
  reason.replace(/^steps\[\d+\]: /, "").replace(/^\w+\[\d+\] \((.+?)\)(?= would cover)/, "the $1");

export class WorldClient {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {(other: boolean) => void} shows called when it has been read, with whether it is another world
   * @param {(text: string) => void} wrong called when an edit was refused
   */
  constructor(link, shows, wrong) {
    this.link = link;
    this.shows = shows;
    this.wrong = wrong;
    /** @type {World | null} */
    this.world = null;
    /** @type {number | null} */
    this.edition = null;
    this.again = false; // somebody has asked again since the last answer
    /** @type {Promise<void> | null} */
    this.loading = null;
    /** @type {Promise<boolean>} */
    this.busy = Promise.resolve(true);
  }

  // Resolves when the world has been read as it is now. A caller that asks while an answer is under way waits for one more.
  load() {
    this.again = true;
    this.loading ??= (async () => {
      while (this.again) {
        this.again = false;
        await this.fetch();
      }
      this.loading = null;
    })();
    return this.loading;
  }

  async fetch() {
    try {
      const { world, edition } = await (await fetch("/api/world")).json();
      if (!world) return;
      const other = this.world?.name !== world.name;
      this.world = world;
      this.edition = edition;
      this.shows(other);
    } catch {
      // The connection is lost, as the page says. The world is read again with the next state.
      this.edition = null;
    }
  }

  /**
   * One edit: `makes(world)` gives its steps, or a sentence that says why there are none. Resolves to whether it was done.
   * @param {(world: World) => EditStep[] | string} makes
   */
  edit(makes) {
    return this.send(() => {
      if (!this.world) return null;
      const steps = makes(this.world);
      if (typeof steps === "string") this.wrong(steps);
      return typeof steps === "string" || !steps.length ? null : { type: "edit_world", steps, edition: this.edition };
    });
  }

  undo() {
    return this.send(() => ({ type: "undo_edit" }));
  }

  redo() {
    return this.send(() => ({ type: "redo_edit" }));
  }

  /** @param {() => Command | null} command */
  async send(command) {
    const before = this.busy;
    this.busy = (async () => {
      await before; // of edits in quick succession, each is made on the result of the one before
      const wish = command();
      if (!wish) return false;
      const answer = await this.link.ask(wish, { quiet: true });
      if (answer.accepted) await this.load();
      else
        this.wrong(
          answer.detail.map((/** @type {Wrong} */ wrong) => sentence(plainly(wrong.reason))).join(" ") ||
            "The connection is lost; nothing was changed.",
        );
      return answer.accepted;
    })();
    return this.busy;
  }
}

/** The dialog that saves the office under a name. */
export class SaveDialog {
  /** @param {WorldClient} office */
  constructor(office) {
    this.office = office;
    /** @type {Record<string, string>} */
    this.yours = {};
    $("save-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.save();
    });
    $("save-name").addEventListener("input", () => this.showRename());
    $("save-close").addEventListener("click", () => $("save-dialog").close());
  }

  async ask() {
    const { world } = this.office;
    if (!world) return;
    const { yours, ours } = await worlds();
    this.yours = yours;
    $("save-name").value = world.name in ours ? `my-${world.name}` : world.name;
    $("save-title").value = world.title;
    $("save-wrong").hidden = true;
    for (const flag of [$("save-replace"), $("save-rename")]) flag.checked = false;
    $("save-replace-row").hidden = true;
    this.showRename();
    $("save-dialog").showModal();
    $("save-name").select();
  }

  showRename() {
    const { name = "", title } = this.office.world ?? {};
    const other = name in this.yours && $("save-name").value.trim() !== name;
    $("save-rename-row").hidden = !other;
    $("save-rename-words").textContent = `Rename: “${title}”, saved as ${name}, goes`;
  }

  async save() {
    const reply = await post("/api/worlds/save", {
      name: $("save-name").value.trim(),
      title: $("save-title").value.trim() || null,
      replace: $("save-replace").checked,
      rename: $("save-rename").checked && !$("save-rename-row").hidden,
    });
    if (!reply.wrong) {
      $("save-dialog").close();
      toast(`Saved as ${reply.file}`);
      return;
    }
    $("save-wrong").textContent = reply.wrong;
    $("save-wrong").hidden = false;
    $("save-replace-row").hidden = reply.field !== "replace";
  }
}
