// The places that people have named: a form that names the one where the robot is, and a button for each to send it there.

import { make, removeButton, renew } from "../ui/elements.js";
import { heading, note } from "./parts.js";

export class TagList {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    this.ask = ask;
    const name = make("input", { type: "text", maxLength: 40, required: true, autocomplete: "off" });
    name.setAttribute("aria-label", "name of this place");
    name.placeholder = "the kitchen";
    const form = make(
      "form",
      { className: "tag" },
      name,
      make("button", { type: "submit", textContent: "Robot is here" }),
    );
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const answer = await this.ask({ type: "tag", name: name.value });
      if (answer.accepted) name.value = "";
    });
    this.list = make("ul", { className: "tags" });
    this.empty = note("None has a name yet. Name the place where the robot is, and a click on the name sends it back.");
    this.box = make("section", {}, heading("Places"), form, this.list, this.empty);
  }

  /** @param {{ tags: string[] }} data */
  show({ tags }) {
    renew(this.list, tags, () => tags.map((name) => this.row(name)));
    this.empty.hidden = tags.length > 0;
  }

  /** @param {string} name */
  row(name) {
    const go = make("button", { type: "button", className: "choice", textContent: name });
    go.dataset.key = name;
    go.setAttribute("aria-label", `go to ${name}`);
    go.addEventListener("click", () => this.ask({ type: "go_to_tag", name }));
    const remove = removeButton(`forget the name ${name}`);
    remove.addEventListener("click", () => this.ask({ type: "untag", name }));
    return make("li", {}, go, remove);
  }
}
