// Office: what moves in this world, one switch each, the robot's presets, and the places with a name. After a refusal a switch goes back.

import { make, removeButton, renew, say } from "../ui/elements.js";
import { Knob } from "./tune.js";
import { heading, note } from "./parts.js";

const OWN = "own settings";

/** @typedef {{ input: HTMLInputElement, box: HTMLElement }} Leaf */

export class OfficeTab {
  /** @param {import("./panel.js").Ask} ask */
  constructor(ask) {
    this.ask = ask;
    this.words = note("");
    this.preset = make("select");
    this.preset.setAttribute("aria-label", "preset");
    this.preset.addEventListener("change", () => this.choose());
    this.robot = make(
      "section",
      {},
      heading("Robot"),
      make(
        "label",
        { className: "knob", title: "Sets the robot's sensors and encoders; the Tune tab shows to what." },
        make("span", { textContent: "preset" }),
        this.preset,
      ),
    );
    this.lives = make("section");
    this.doors = make("section");
    this.lamps = make("section");
    this.tags = new TagList(ask);
    this.box = make("div", {}, this.words, this.tags.box, this.robot, this.lives, this.doors, this.lamps);
    /** @type {Map<string, Knob>} */
    this.knobs = new Map();
    /** @type {any} as the session last said */
    this.data = null;
  }

  /** @param {any} data */
  office(data) {
    this.data = data;
    say(this.words, data.words);
    this.robot.hidden = data.presets.length === 0;
    renew(this.preset, data.presets, () => [OWN, ...data.presets].map((name) => new Option(name)));
    if (document.activeElement !== this.preset) this.preset.value = data.preset || OWN;
    const names = data.knobs.map((/** @type {{ name: string }} */ { name }) => name);
    renew(this.lives, names, () => this.build(data.knobs));
    for (const parameter of data.knobs) this.knobs.get(parameter.name)?.show(parameter);
    this.leaves(this.doors, "Doors", data.doors, "Open or shut; a click on the leaf does the same.", (name, on) => ({
      type: "set_door",
      name,
      open: on,
    }));
    this.leaves(this.lamps, "Lamps", data.lamps, "On or off.", (name, on) => ({ type: "set_lamp", name, on }));
  }

  async choose() {
    const name = this.preset.value;
    if (name !== OWN) await this.ask({ type: "use_preset", name });
    this.preset.value = this.data.preset || OWN; // the session decides which one is shown
    this.preset.blur();
  }

  /** @param {import("./tune.js").Parameter[]} parameters */
  build(parameters) {
    this.knobs = new Map(parameters.map((parameter) => [parameter.name, new Knob(parameter, this.ask)]));
    const boxes = [...this.knobs.values()].map(({ box }) => box);
    return boxes.length ? [heading("What lives"), ...boxes] : [];
  }

  /**
   * Switches of one kind.
   * @param {HTMLElement} box @param {string} title @param {[string, boolean][]} leaves @param {string} hint
   * @param {(name: string, on: boolean) => Command} command
   */
  leaves(box, title, leaves, hint, command) {
    renew(
      box,
      leaves.map(([name]) => name),
      () => {
        const drawn = leaves.map(([name]) => this.leaf(name, hint, command));
        return drawn.length ? [heading(title), ...drawn] : [];
      },
    );
    const inputs = box.querySelectorAll("input");
    leaves.forEach(([, on], k) => {
      if (!inputs[k].dataset.asking) inputs[k].checked = on;
    });
  }

  /** @param {string} name @param {string} hint @param {(name: string, on: boolean) => Command} command */
  leaf(name, hint, command) {
    const input = make("input", { type: "checkbox" });
    input.dataset.key = name;
    input.addEventListener("change", async () => {
      const wanted = input.checked;
      input.dataset.asking = "yes";
      const answer = await this.ask(command(name, wanted));
      delete input.dataset.asking;
      if (!answer.accepted) input.checked = !wanted;
    });
    return make("label", { className: "check", title: hint }, input, make("span", { textContent: name }));
  }

  get parts() {
    return { office: this.office.bind(this), tags: this.tags.show.bind(this.tags) };
  }
}

/** The places that people have named: a form that names the one where the robot is, and a button for each to send it there. */
class TagList {
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
    this.empty = note("No place is named yet. Name where the robot is; a click on the name sends it back.");
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
