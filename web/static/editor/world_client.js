// The office as the engine has it. It is read again after each change; edits, undo and redo go one after the other.

import { sentence } from "../ui/words.js";

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
