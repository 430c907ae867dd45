// The dialog that saves the office under a name.

import { sentence } from "./files.js";
import { toast } from "./toasts.js";

const $ = (id) => document.getElementById(id);

export class SaveDialog {
  constructor(office) {
    this.office = office;
    $("save-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.save();
    });
    $("save-close").addEventListener("click", () => $("save-dialog").close());
  }

  ask() {
    const { world, ours } = this.office;
    if (!world) return;
    $("save-name").value = world.name in ours ? `my-${world.name}` : world.name;
    $("save-title").value = world.title;
    $("save-wrong").hidden = true;
    $("save-replace-row").hidden = true;
    $("save-replace").checked = false;
    $("save-dialog").showModal();
    $("save-name").select();
  }

  async save() {
    const body = { name: $("save-name").value.trim(), title: $("save-title").value.trim() || null, replace: $("save-replace").checked };
    let told;
    try {
      const answer = await fetch("/api/worlds/save", {
        method: "POST", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body),
      });
      told = await answer.json();
    } catch {
      told = { detail: [{ reason: "the connection is lost; nothing was saved" }] };
    }
    if (told.file) {
      $("save-dialog").close();
      toast(`Saved as ${told.file}`);
      return;
    }
    $("save-wrong").textContent = told.detail.map((wrong) => sentence(wrong.reason)).join(" ");
    $("save-wrong").hidden = false;
    $("save-replace-row").hidden = told.detail[0].field !== "replace";
  }
}
