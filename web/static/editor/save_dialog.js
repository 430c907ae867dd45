// The dialog that saves the office under a name.

import { $ } from "../ui/elements.js";
import { post, worlds } from "../net/post.js";
import { toast } from "../ui/toasts.js";

export class SaveDialog {
  /** @param {import("./world_client.js").WorldClient} office */
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
    const told = await post("/api/worlds/save", {
      name: $("save-name").value.trim(),
      title: $("save-title").value.trim() || null,
      replace: $("save-replace").checked,
      rename: $("save-rename").checked && !$("save-rename-row").hidden,
    });
    if (!told.wrong) {
      $("save-dialog").close();
      toast(`Saved as ${told.file}`);
      return;
    }
    $("save-wrong").textContent = told.wrong;
    $("save-wrong").hidden = false;
    $("save-replace-row").hidden = told.field !== "replace";
  }
}
