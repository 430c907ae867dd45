// The office as the engine has it: read again after each change; edits one after the other, undo and redo.

import { sentence } from "./files.js";

export class Office {
  // `shows()` when it has been read, `wrong(text)` when an edit was refused.
  constructor(link, shows, wrong) {
    Object.assign(this, { link, shows, wrong, world: null, edition: null });
  }

  // Resolves when it has been read as it is now: who asks while an answer is under way waits for one more.
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
      Object.assign(this, { world, edition });
      this.shows(other);
    } catch {
      // the connection is lost, which the page says; it is read again with the next state
      this.edition = null;
    }
  }

  // One edit: the steps that `makes()` gives, or a sentence that says why there are none. Resolves to whether it was done.
  edit(makes) {
    return this.send(() => {
      const steps = makes();
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

  async send(command) {
    const before = this.busy;
    this.busy = (async () => {
      await before; // edits that follow each other quickly are made on what the one before left
      const wish = command();
      if (!wish) return false;
      const answer = await this.link.ask(wish, { quiet: true });
      if (answer.accepted) await this.load();
      else this.wrong(answer.detail.map((wrong) => sentence(wrong.reason.replace(/^steps\[\d+\]: /, ""))).join(" ") || "The connection is lost; nothing was changed.");
      return answer.accepted;
    })();
    return this.busy;
  }
}
