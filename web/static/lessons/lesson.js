// The lesson's card beside the stage. In each state it shows what that is about: the question, what to watch, what came of it, what to
// try. All else unfolds. The server says which state the lesson is in; all pages show the same.

import { $, find, icon, make, renew, say } from "../ui/elements.js";
import {
  classWords,
  doingWords,
  isBroken,
  isOpen,
  isPlanShown,
  isWatched,
  moments,
  placeWords,
  showWords,
  tabOf,
  unfolded,
  verdict,
  which,
  Question,
} from "./question.js";
import { sourceWords } from "../ui/words.js";
import { linked, nextAfter, setDone } from "./list.js";
import { phone } from "../viewer/viewer.js";
import { TABS, VIEWS } from "../shared.js";

export class Lesson {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {import("./list.js").LessonList} list
   * @param {{ viewer: import("../viewer/viewer.js").Viewer, panel: import("../panel/panel.js").Panel,
   *   timeline: import("../timeline/timeline.js").Timeline }} page
   */
  constructor(link, list, { viewer, panel, timeline }) {
    this.link = link;
    this.list = list;
    this.viewer = viewer;
    this.panel = panel;
    this.timeline = timeline;
    this.box = $("lesson");
    /** @type {LessonView | null} */
    this.now = null;
    /** @type {LessonText | null} */
    this.text = null;
    /** @type {Question | null} */
    this.question = null;
    /** @type {LessonCard | null} */
    this.after = null; // the next one
    /** @type {Pose | null} */
    this.robot = null;
    this.rate = 0.1; // seconds a tick
    this.invitation = new Invitation();
    /** @type {string | null} */
    this.wanted = null; // the lesson that the address names, until it is known what goes on
    this.heard = false;
    $("lesson-show").addEventListener("click", () => this.go());
    $("lesson-again").addEventListener("click", () => this.ask({ type: "lesson_again" }));
    $("lesson-next").addEventListener("click", () => this.next());
    $("lesson-leave").addEventListener("click", () => this.ask({ type: "end_lesson" }));
    $("lesson-what").addEventListener("toggle", fitFormulas); // folded, they have no width
    $("lesson-fold").addEventListener("click", () => this.fold(this.box.dataset.folded !== "true"));
    document.addEventListener("presenter:next", (event) => this.present(event, 1));
    document.addEventListener("presenter:back", (event) => this.present(event, -1));
    window.addEventListener("hashchange", () => this.follow());
    link.addEventListener("hello", () => this.follow());
  }

  /** Begins the lesson that the address names, unless it goes on already: a class that opens one link is in one lesson. */
  follow() {
    const name = linked(location.hash);
    if (!name || this.link.watches) return;
    history.replaceState(null, "", location.pathname + location.search); // loaded again, the page shows the lesson as it is
    this.wanted = name;
    if (this.heard) this.begin();
  }

  begin() {
    const name = this.wanted;
    this.wanted = null;
    if (name && this.now?.name !== name) this.list.begin(name);
  }

  /** @param {State} state */
  at({ lesson, tick, time_s, robot, estimate }) {
    const before = this.now;
    this.now = lesson;
    this.heard = true;
    this.begin();
    this.robot = lesson?.draws === "map" ? estimate : robot;
    if (tick > 0) this.rate = time_s / tick;
    if (!lesson) {
      this.box.hidden = true;
      this.text = null;
      return;
    }
    if (lesson.name !== before?.name || lesson.state !== before.state) this.entered(lesson, before);
    this.draw();
  }

  /** @param {LessonView} lesson @param {LessonView | null} before */
  entered(lesson, before) {
    if (lesson.name !== before?.name || this.box.hidden) this.read(lesson.name);
    else if (lesson.state === "showing") this.look();
    if (lesson.state === "compared") setDone(lesson.name);
    if (before && lesson.state !== before.state) $("lesson-body").scrollTop = 0;
    const open = unfolded(lesson);
    $("lesson-ask").open = open.question;
    $("lesson-outcome").open = open.outcome;
    $("lesson-try").open = open.sandbox;
    if (phone()) this.fold(lesson.state === "showing");
  }

  /** All texts of the lesson, and the focus into its card. @param {string} name */
  async read(name) {
    this.text = null;
    const [answer, cards] = await Promise.all([fetch(`/api/lessons/${name}`), this.list.look()]).catch(() => []);
    const text = /** @type {LessonText | null} */ (answer?.ok ? await answer.json() : null);
    if (!text || this.now?.name !== name) return;
    this.text = text;
    this.after = nextAfter(cards ?? [], name);
    this.question = new Question(text.predict, (said) => this.ask({ type: "predict", ...said }), this.link.watches);
    $("lesson-question").replaceChildren(this.question.box);
    $("lesson-drawn").replaceChildren(...this.question.drawn, this.invitation.hint);
    this.invitation.look();
    $("lesson-formulas").replaceChildren(
      ...text.formulas.map((formula) => formulaBox(formula, (name) => this.tune(name), this.panel.valueOf)),
    );
    say($("lesson-title"), text.card.title);
    say($("lesson-paper"), sourceWords(text.card.paper));
    say($("lesson-text"), text.text);
    $("lesson-what").open = false;
    this.fold(false);
    this.look();
    this.draw();
    $("lesson-title").focus({ preventScroll: true });
  }

  /** The plate and the tab of the question; then the plate that is to be watched first. */
  look() {
    if (!this.text) return;
    const watched = VIEWS.find((name) => name === this.text?.watch[0]?.at);
    const turns = this.now?.state === "showing" && this.text.view !== "all";
    this.viewer.show((turns && watched) || this.text.view);
    const tab = tabOf(this.text.tab, TABS);
    if (tab) this.panel.open(tab);
  }

  draw() {
    const { now: lesson, text } = this;
    this.box.hidden = !lesson || !text;
    if (!lesson || !text) return;
    this.box.dataset.state = lesson.state;
    say($("lesson-which"), which(lesson, text.card));
    this.question?.show(lesson, lesson.prediction, this.robot);
    this.box.dataset.asks = String(isOpen(lesson));
    $("lesson-drawn").hidden = !isPlanShown(lesson);
    this.invitation.show(lesson);
    $("lesson-watch").hidden = !isWatched(lesson);
    renew($("lesson-watch"), text.watch, () => this.watch(text));
    renew($("lesson-outcome"), [lesson.outcome, lesson.prediction, lesson.marks.map(({ tick }) => tick)], () =>
      this.outcome(lesson, text),
    );
    const after = lesson.state === "compared" || lesson.state === "sandbox";
    $("lesson-try").hidden = !after || !text.sandbox.length;
    renew($("lesson-try"), text.sandbox, () => this.sandbox(text));
    say($("lesson-doing"), doingWords(lesson));
    $("lesson-done").hidden = lesson.progress === null;
    $("lesson-done").value = lesson.progress ?? 0;
    const words = showWords(lesson);
    $("lesson-show").hidden = words === null;
    say($("lesson-show"), words ?? "");
    $("lesson-again").hidden = !after;
    $("lesson-again").classList.toggle("go", isBroken(lesson));
    $("lesson-next").hidden = !after || !this.after;
    $("lesson-next").title = this.after ? `Next: ${this.after.title}` : "";
  }

  /** @param {LessonText} text */
  watch({ watch }) {
    const rows = watch.map(({ at, words }) => {
      const button = make("button", { type: "button", textContent: placeWords(at) });
      button.addEventListener("click", () => this.show(at));
      return make("li", {}, button, make("span", { textContent: words }));
    });
    return [make("h3", { textContent: "What to watch" }), make("ul", { className: "watch" }, ...rows)];
  }

  /** @param {LessonView} lesson @param {LessonText} text */
  outcome(lesson, text) {
    if (!lesson.outcome) return [];
    const { tone, head, said } = verdict(lesson, text.predict);
    const counted = lesson.outcome.choice === null ? "" : classWords(lesson);
    const signs = { right: "check", wrong: "close", none: "info" };
    const rows = moments(lesson.marks, (tick) => tick * this.rate).map(({ tick, words, at }) => {
      const button = make("button", { type: "button" }, make("time", { textContent: at }), words);
      button.dataset.key = `${tick} ${words}`;
      button.title = "Show this moment";
      button.disabled = this.link.watches;
      button.addEventListener("click", () => this.timeline.seeker.seek({ tick }));
      return make("li", {}, button);
    });
    const why = make("button", { type: "button", textContent: "Inspect: why it happened" });
    why.addEventListener("click", () => this.show("inspect"));
    $("lesson-outcome").dataset.tone = tone;
    return [
      make("summary", {}, make("h3", {}, icon(signs[tone]), head)),
      ...(said ? [make("p", { className: "second" }, make("b", { textContent: "Predicted: " }), said)] : []),
      make("p", { className: "happened", textContent: lesson.outcome.words }),
      make("p", { textContent: lesson.outcome.because }),
      ...(counted ? [make("p", { className: "second", textContent: counted })] : []),
      ...(text.more ? [folded("More", make("p", { className: "second", textContent: text.more }))] : []),
      ...(text.explains ? [why] : []),
      ...(rows.length ? [folded("Moments", make("ol", { className: "moments" }, ...rows))] : []),
    ];
  }

  /** @param {LessonText} text */
  sandbox({ sandbox }) {
    const rows = sandbox.map(({ words, button, commands }) => {
      const row = make("li", {}, make("span", { textContent: words }));
      if (button === null) return row;
      const press = make("button", { type: "button", textContent: button });
      press.addEventListener("click", async () => {
        for (const command of commands) if (!(await this.ask(command))) return;
      });
      row.append(press);
      return row;
    });
    return [make("summary", { textContent: "Try it" }), make("ul", { className: "try" }, ...rows)];
  }

  /** @param {string} at a plate, a tab, or the timeline */
  show(at) {
    const view = VIEWS.find((name) => name === at);
    const tab = tabOf(at, TABS);
    if (view) this.viewer.show(view);
    else if (tab) {
      this.panel.open(tab);
      this.panel.show(true);
    } else $("timeline").focus();
  }

  /** @param {string} parameter */
  tune(parameter) {
    this.panel.show(true);
    this.panel.tune(parameter);
  }

  /** @param {Command} command */
  async ask(command) {
    return (await this.link.ask(command)).accepted;
  }

  go() {
    return this.ask({ type: "show_lesson" });
  }

  next() {
    if (this.after) this.list.begin(this.after.name);
  }

  /** A clicker's key: on is "let it happen", then the next lesson; back is "once more". @param {Event} event @param {1 | -1} step */
  present(event, step) {
    if (!this.now || this.box.hidden) return;
    const { state } = this.now;
    const over = state === "compared" || state === "sandbox";
    if (step > 0 && state === "predict") this.go();
    else if (step > 0 && over && this.after) this.next();
    else if (step < 0 && over) this.ask({ type: "lesson_again" });
    else if (state !== "scene") return;
    event.preventDefault();
  }

  /** @param {boolean} on */
  fold(on) {
    this.box.dataset.folded = String(on);
    $("lesson-fold").setAttribute("aria-expanded", String(!on));
    $("lesson-fold").setAttribute("aria-label", on ? "Unfold the card" : "Fold the card");
  }
}

/** @param {string} words @param {HTMLElement} content */
const folded = (words, content) => make("details", {}, make("summary", { textContent: words }), content);

/** Where the class votes: large and with a QR code for whoever looks at a screen from afar, else a line below the question. */
class Invitation {
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
    this.hint.replaceChildren(...(vote ? ["The class votes at ", here, "."] : [here]));
    here.title = vote ? "" : "On this machine; started with ratslam run --class, on their phones";
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
    this.hint.hidden = !this.open;
  }
}

const MATHML = "http://www.w3.org/1998/Math/MathML";

/** @param {string} text @returns {Element} */
function mathOf(text) {
  const parsed = new DOMParser().parseFromString(text, "application/xml").documentElement;
  return copied(parsed) ?? document.createElementNS(MATHML, "math");
}

/** @param {Element} from @returns {Element | null} */
function copied(from) {
  if (from.namespaceURI !== MATHML || !/^(math|m[a-z]+)$/.test(from.localName)) return null;
  const made = document.createElementNS(MATHML, from.localName);
  for (const { name, value } of from.attributes)
    if (!name.startsWith("on") && !name.includes(":") && name !== "href" && name !== "style" && name !== "xmlns")
      made.setAttribute(name, value);
  for (const child of from.childNodes) {
    if (child.nodeType === Node.TEXT_NODE) made.append(child.textContent ?? "");
    else if (child instanceof Element) made.append(copied(child) ?? "");
  }
  return made;
}

/**
 * @param {FormulaText} formula
 * @param {(parameter: string) => void} tune
 * @param {(parameter: string) => string | null} valueNow null: unknown; the lesson's own value is shown
 */
export function formulaBox(formula, tune, valueNow) {
  const math = mathOf(formula.mathml);
  for (const part of math.querySelectorAll("[data-parameter]")) {
    const name = part.getAttribute("data-parameter") ?? "";
    const symbol = formula.symbols.find(({ parameter }) => parameter === name);
    part.addEventListener("click", () => tune(name));
    part.addEventListener("pointerenter", () =>
      part.setAttribute("title", `${symbol?.means ?? name}: ${valueNow(name) ?? symbol?.value ?? "?"}`),
    );
  }
  return make(
    "figure",
    { className: "formula" },
    make("div", { className: "math", tabIndex: 0, role: "group", ariaLabel: `Formula, ${formula.source}` }, math),
    make("figcaption", {}, formula.says, make("span", { className: "second", textContent: ` ${formula.source}` })),
    make("ul", { className: "symbols" }, ...formula.symbols.map((symbol) => symbolRow(symbol, tune, valueNow))),
  );
}

/** @param {SymbolText} symbol @param {(parameter: string) => void} tune @param {(parameter: string) => string | null} valueNow */
function symbolRow({ mathml, means, parameter, value }, tune, valueNow) {
  if (parameter === null) return make("li", {}, mathOf(mathml), make("span", { textContent: means }));
  const now = make("b", { textContent: valueNow(parameter) ?? value ?? "" });
  const button = make("button", { type: "button" }, mathOf(mathml), make("span", { textContent: means }), now);
  button.title = `${parameter}: open it in Tune`;
  const look = () => (now.textContent = valueNow(parameter) ?? value ?? "");
  for (const kind of /** @type {const} */ (["pointerenter", "focus"])) button.addEventListener(kind, look);
  button.addEventListener("click", () => tune(parameter));
  return make("li", {}, button);
}

// A formula that is wider than the card is set smaller; what is wider still can be scrolled.
export function fitFormulas() {
  for (const math of /** @type {NodeListOf<HTMLElement>} */ ($("lesson-formulas").querySelectorAll(".math"))) {
    math.style.fontSize = "";
    const share = math.clientWidth / math.scrollWidth;
    if (share < 1) math.style.fontSize = `${Math.max(0.74, 1.06 * share).toFixed(2)}em`;
  }
}
