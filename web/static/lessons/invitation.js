// Where the class votes: large and with a QR code for whoever looks at a screen from afar, else a line below the question.

import { $, find, make } from "../ui/elements.js";
import { isOpen } from "./words.js";

export class Invitation {
  constructor() {
    this.box = $("lesson-class");
    this.hint = make("p", { className: "second vote-link" });
    this.there = this.open = false; // a class can reach this program; and its votes count now
  }

  /** Asks where the class votes. */
  async look() {
    /** @type {{ vote: string | null }} */
    const { vote } = await fetch("/api/class").then(
      (answer) => answer.json(),
      () => ({ vote: null }),
    );
    this.there = vote !== null;
    const here = make("a", { href: vote ?? "/?vote", target: "_blank", textContent: vote ?? "Let the class vote" });
    if (vote) this.hint.replaceChildren("The class votes at ", here, ".");
    else this.hint.replaceChildren(here, " on this machine; started with ", command(), ", on their phones.");
    if (!vote) return;
    const image = /** @type {HTMLImageElement} */ (find(this.box, "img"));
    if (!image.src) image.src = "/api/class.svg";
    const link = /** @type {HTMLAnchorElement} */ (find(this.box, "a"));
    link.href = vote;
    const [, name, port] = /^http:\/\/(.*?)(:\d+)?\/$/.exec(vote) ?? ["", vote, ""];
    link.replaceChildren(name, make("wbr"), port ?? "");
    this.draw();
  }

  /** @param {LessonView} lesson */
  show(lesson) {
    this.open = isOpen(lesson);
    this.draw();
  }

  draw() {
    this.box.hidden = !this.there || !this.open;
  }
}

const command = () => make("code", { textContent: "ratslam run --class" });
