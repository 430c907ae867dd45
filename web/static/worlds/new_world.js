// The dialog that begins a new, empty world.

import { $ } from "../ui/elements.js";
import { post, worlds } from "../net/post.js";
import { toast } from "../ui/toasts.js";

/** The first of my-world, my-world-2, ... that no world has. @param {WorldTitles} taken */
export function freeName({ yours, ours }) {
  let k = 1;
  const name = () => (k > 1 ? `my-world-${k}` : "my-world");
  while (name() in yours || name() in ours) k += 1;
  return name();
}

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
    const told = await post("/api/worlds/new", {
      name: $("new-name").value.trim(),
      title: $("new-title").value.trim() || null,
      width_m: Number($("new-width").value),
      depth_m: Number($("new-depth").value),
    });
    $("new-wrong").hidden = !told.wrong;
    $("new-wrong").textContent = told.wrong ?? "";
    if (told.wrong) return;
    $("new-dialog").close();
    toast(`${told.title}: an empty room of ${told.size_m.join(" × ")} m. The robot starts in it.`);
    this.begun();
  }
}
