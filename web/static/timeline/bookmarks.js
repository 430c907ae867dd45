// Moments that somebody has named: a list in the box of events, and marks on the timeline.

import { $, icon, labelled, make, svg } from "../ui/elements.js";
import { fine } from "../ui/words.js";

export class Bookmarks {
  /** @param {import("./timeline.js").Timeline} timeline @param {import("../net/connection.js").Connection} link */
  constructor(timeline, link) {
    this.timeline = timeline;
    this.link = link;
    this.told = "";
    /** @type {Bookmark[]} */
    this.rows = [];
    /** @type {number | null} */
    this.naming = null; // the tick of the bookmark whose name is being written
    /** @type {() => unknown} */
    this.share = () => {}; // makes a link of the moment that is shown
    $("bookmark").addEventListener("click", () => this.put());
  }

  /** Names the moment that is shown by its time; the name can be written at once. */
  async put() {
    const tick = this.timeline.tick;
    if (!this.timeline.list.open) this.timeline.list.toggle();
    if (this.rows.some((row) => row.tick === tick)) return this.name(tick);
    const answer = await this.link.ask({ type: "put_bookmark", name: fine(this.timeline.time_s) });
    if (answer.accepted) this.naming = answer.tick ?? tick;
    this.draw();
  }

  /** @param {TimeFields} time */
  show({ bookmarks }) {
    const told = JSON.stringify(bookmarks);
    if (told === this.told) return;
    this.told = told;
    this.rows = bookmarks;
    this.draw();
    this.timeline.redraw(true);
  }

  draw() {
    $("bookmarks").hidden = this.rows.length === 0;
    $("bookmark-list").replaceChildren(...this.rows.map((row) => this.row(row)));
    const field = $("bookmark-list").querySelector("input");
    field?.focus();
    field?.select();
  }

  /** @param {number | null} tick */
  name(tick) {
    this.naming = tick;
    this.draw();
  }

  /** @param {Bookmark} bookmark */
  row({ tick, time_s, name }) {
    if (tick === this.naming) return make("li", {}, this.form(tick, name));
    const go = make("button", { type: "button", className: "go-there" });
    go.append(make("time", { textContent: fine(time_s) }), make("span", { textContent: name }));
    go.addEventListener("click", () => this.timeline.seeker.seek({ tick }));
    return make(
      "li",
      {},
      go,
      this.button("edit", `Another name for ${name}`, () => this.name(tick)),
      this.button("share", `Link to ${name}`, async () => {
        await this.timeline.seeker.seek({ tick });
        this.share();
      }),
      this.button("delete", `Delete ${name}`, () => this.link.ask({ type: "remove_bookmark", tick })),
    );
  }

  /** @param {string} picture @param {string} words @param {() => unknown} action */
  button(picture, words, action) {
    const button = labelled(words, make("button", { type: "button", className: "tiny" }, icon(picture)));
    button.addEventListener("click", action);
    return button;
  }

  /** @param {number} tick @param {string} name */
  form(tick, name) {
    const field = labelled(
      "Name of the bookmark",
      make("input", { type: "text", value: name, maxLength: 60, required: true, autocomplete: "off" }),
    );
    const form = make("form", {}, field, make("button", { type: "submit", className: "tiny", textContent: "Name it" }));
    form.addEventListener("submit", async (event) => {
      event.preventDefault();
      const wish = field.value.trim();
      this.naming = null;
      if (wish && wish !== name) await this.link.ask({ type: "put_bookmark", name: wish, tick });
      this.draw();
    });
    field.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.name(null);
      $("bookmark").focus();
    });
    return form;
  }

  /** @param {import("./line.js").Axis} x @param {number} y @param {number} from @param {number} to */
  marks(x, y, from, to) {
    return this.rows
      .filter(({ time_s }) => time_s >= from && time_s <= to)
      .map(({ time_s, name }) =>
        svg(
          "path",
          { d: `M${x(time_s) - 3.5} ${y + 4}h7v9l-3.5-3-3.5 3z`, class: "bookmark" },
          svg("title", {}, `${fine(time_s)} ${name}`),
        ),
      );
  }
}
