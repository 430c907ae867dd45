// The places that the robot knows as a list, for who does not see the map: type, choose, go there or look at it.

import { $ } from "../elements/dom.js";
import { make } from "../elements/elements.js";
import { choices } from "../model/places.js";
import { get } from "../net/post.js";
import { renew } from "../panel/parts.js";

const MOST = 60; // rows
const touched = window.matchMedia("(pointer: coarse)");

export class PlaceList {
  /**
   * @param {(wish: Command, done?: string) => Promise<boolean>} command
   * @param {() => void} inspected called when a place is to be looked at
   */
  constructor(command, inspected) {
    this.command = command;
    this.inspected = inspected;
    this.dialog = $("places-dialog");
    /** @type {import("../model/places.js").Places | null} */
    this.places = null;
    $("places-close").addEventListener("click", () => this.dialog.close());
    this.dialog.addEventListener("click", ({ target }) => target === this.dialog && this.dialog.close());
    $("places-typed").addEventListener("input", () => this.draw());
    $("places-form").addEventListener("submit", (event) => {
      event.preventDefault();
      const first = this.found.find(({ why }) => !why);
      if (first) this.go(first);
    });
  }

  /** @param {boolean} byKey */
  async open(byKey) {
    this.places = null;
    $("places-typed").value = "";
    $("places-said").textContent = "Asking the robot";
    this.dialog.showModal();
    if (byKey || !touched.matches) $("places-typed").focus(); // a keyboard on the screen would cover the list
    const { told, wrong } = await get("/api/places");
    this.places = told;
    if (wrong) $("places-said").textContent = wrong;
    this.draw();
  }

  get found() {
    return this.places ? choices(this.places, $("places-typed").value, MOST) : [];
  }

  draw() {
    const { found } = this;
    renew(
      $("places-list"),
      found.map((choice) => `${choice.title} ${choice.where}`),
      () => found.map((choice) => this.row(choice)),
    );
    if (!this.places) return;
    const { tags, named, experiences } = this.places;
    const all = tags.length + named.length + experiences.length;
    $("places-said").textContent =
      found.length < all ? `${found.length} of ${all} places. A number finds the others.` : `${all} places`;
  }

  /** @param {import("../model/places.js").Choice} choice */
  row(choice) {
    const go = make(
      "button",
      { type: "button", className: "go-there" },
      make("b", { textContent: choice.title }),
      ` ${choice.where}`,
    );
    if (choice.why) {
      go.setAttribute("aria-disabled", "true"); // so that the keyboard comes to it, and the reason is read
      go.setAttribute("aria-label", `${choice.title} cannot be gone to: ${choice.why}`);
      return make("li", {}, go);
    }
    go.setAttribute("aria-label", `Go to ${choice.title}, ${choice.where}`);
    go.addEventListener("click", () => this.go(choice));
    const look = make("button", { type: "button", textContent: "Inspect" });
    look.setAttribute("aria-label", `Inspect ${choice.title}`);
    look.addEventListener("click", () => this.look(choice));
    return make("li", {}, go, look);
  }

  /** @param {import("../model/places.js").Choice} choice */
  async go({ tag, x, y, title }) {
    this.dialog.close();
    await this.command(
      tag === null ? { type: "set_goal", x, y } : { type: "go_to_tag", name: tag },
      `On the way to ${title}.`,
    );
  }

  /** @param {import("../model/places.js").Choice} choice */
  async look({ experience }) {
    this.dialog.close();
    if (await this.command({ type: "inspect", experience })) this.inspected();
  }
}
