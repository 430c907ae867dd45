// The dialog that begins a new, empty world.

import { post, worlds } from "./post.js";
import { toast } from "./toasts.js";

const $ = (id) => document.getElementById(id);

export class NewWorld {
  // `isSaved()`: whether nothing would be lost; `begun()`: the robot is in it.
  constructor(isSaved, begun) {
    Object.assign(this, { isSaved, begun });
    $("new-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.begin();
    });
    $("new-close").addEventListener("click", () => $("new-dialog").close());
  }

  async ask() {
    const { yours, ours } = await worlds();
    let k = 1;
    const name = () => (k > 1 ? `my-world-${k}` : "my-world");
    while (name() in yours || name() in ours) k += 1;
    $("new-name").value = name();
    $("new-title").value = "";
    $("new-wrong").hidden = true;
    $("new-unsaved").hidden = this.isSaved();
    $("new-dialog").showModal();
    $("new-name").select();
  }

  async begin() {
    const told = await post("/api/worlds/new", {
      name: $("new-name").value.trim(), title: $("new-title").value.trim() || null,
      width_m: Number($("new-width").value), depth_m: Number($("new-depth").value),
    });
    $("new-wrong").hidden = !told.wrong;
    $("new-wrong").textContent = told.wrong ?? "";
    if (told.wrong) return;
    $("new-dialog").close();
    toast(`${told.title}: an empty room of ${told.size_m.join(" × ")} m. The robot starts in it.`);
    this.begun();
  }
}
