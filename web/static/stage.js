// The stage: viser's client in a frame of our own origin, its view buttons, and its panel on a phone.

import { toast } from "./toasts.js";

export const VIEWS = ["all", "office", "pose", "map"];
export const phone = window.matchMedia("(max-width: 760px)");

export class Stage extends EventTarget {
  constructor(link, keys) {
    super();
    this.link = link;
    this.keys = keys;
    this.frame = document.getElementById("stage");
    this.view = phone.matches ? "map" : "all";
    this.panels = !phone.matches;
    this.buttons = [...document.querySelectorAll("[data-view]")];
    for (const button of this.buttons) button.addEventListener("click", () => this.show(button.dataset.view));
    this.mark();
    this.frame.addEventListener("load", () => this.loaded());
    this.frame.src = `/viser/?websocket=ws://${location.host}/viser/ws/${link.page}&hideViserLogo`;
    link.addEventListener("hello", (event) => this.hello(event.detail));
    phone.addEventListener("change", () => this.showPanels(!phone.matches));
  }

  show(view) {
    this.view = view;
    this.mark();
    this.link.tell({ type: "view", name: view });
  }

  mark() {
    for (const button of this.buttons)
      button.setAttribute("aria-pressed", String(button.dataset.view === this.view));
  }

  // A server that started anew knows no view; one that only lost the line still shows what it did.
  hello({ launch }) {
    if (launch === this.launch) return;
    this.launch = launch;
    this.link.tell({ type: "view", name: this.view });
  }

  loaded() {
    const { contentWindow: inside, contentDocument: paper } = this.frame;
    if (!paper || inside.location.href === "about:blank") return;
    // viser reconnects only while its own frame has the focus; the person looks at the page as a whole.
    paper.hasFocus = () => !document.hidden;
    restBeneathTheEditor(inside);
    this.keys.listen(inside);
    this.dispatchEvent(new CustomEvent("inside", { detail: inside }));
    // viser prevents the default of a press on a draggable thing in a passive listener: without effect, but the
    // browser notes an error each time.
    inside.addEventListener("pointerdown", (event) => {
      if (event.target.tagName === "CANVAS") event.preventDefault = () => {};
    }, true);
    paper.addEventListener("click", (event) => this.chosen(event.target.closest(CHOICES), event));
    paper.addEventListener("keydown", (event) => {
      const choice = event.key === "Enter" ? event.target.closest(CHOICES) : null;
      if (choice) this.chosen(choice, event);
    });
    this.style = paper.createElement("style");
    paper.head.append(this.style);
    this.showPanels(this.panels);
    this.wait(paper);
  }

  wait(paper) {
    if (!paper.querySelector("canvas")) {
      setTimeout(() => this.wait(paper), 100);
      return;
    }
    this.frame.classList.add("awake");
    document.getElementById("waiting").hidden = true;
    let looks = 20;
    const timer = setInterval(() => (dismissSlowNotice(paper) || --looks === 0) && clearInterval(timer), 250);
  }

  // A click on a view or a number in the panels: what it stands for is inspected.
  chosen(choice, event) {
    if (!choice) return;
    if (choice.matches(".view-strip")) {
      const { rows, columns, each, views } = choice.dataset;
      const box = choice.getBoundingClientRect();
      const row = Math.floor(((event.clientY - box.top) / box.height) * rows);
      const column = Math.floor(((event.clientX - box.left) / box.width) * columns);
      const view = (row * columns + column) * each;
      if (view < views) this.link.ask({ type: "inspect", view });
    } else if (choice.dataset.view) this.link.ask({ type: "inspect", view: Number(choice.dataset.view) });
    else this.link.ask({ type: "inspect", experience: Number(choice.dataset.experience) });
  }

  // Whoever chooses something sees what is told of it; a page that has just come shows what it showed.
  inspected(name) {
    const before = this.looked;
    this.looked = name;
    if (name === null || before === undefined || name === before) return;
    const inside = this.frame.contentWindow;
    for (const tab of this.frame.contentDocument?.querySelectorAll("[role=tab]") ?? []) {
      if (tab.textContent.trim() !== "Inspect") continue;
      for (const kind of ["pointerdown", "pointerup"]) // viser's tabs can be dragged: a click alone does nothing
        tab.dispatchEvent(new inside.PointerEvent(kind, { bubbles: true, button: 0, isPrimary: true, pointerId: 1 }));
    }
  }

  // On a phone viser's panel would cover the stage; a button brings it.
  showPanels(on) {
    this.panels = on;
    document.getElementById("panels").setAttribute("aria-pressed", String(on));
    document.body.dataset.panels = String(on); // on a phone they take the place of the card of stages
    if (this.style) this.style.textContent = COLOURS + (on ? "" : HIDE_PANEL);
  }
}

const CHOICES = "[data-view], [data-experience], .view-strip";
const HIDE_PANEL = ".mantine-Paper-root[style*='fixed'] { display: none !important; }";
// viser's panel in the page's own colours.
const COLOURS = `
  [data-dock-tab] { padding: 0 .42em !important; font-size: 12.5px; }
  :root[data-mantine-color-scheme="dark"] {
    --mantine-color-body: #151c26 !important; --mantine-color-default: #202a37 !important;
    --mantine-color-default-hover: #2b3747 !important; --mantine-color-default-border: #2f3b4b !important;
    --mantine-color-text: #e8edf4 !important; --mantine-color-dimmed: #97a5b8 !important;
    --mantine-color-dark-4: #2f3b4b !important; --mantine-color-dark-5: #2b3747 !important;
    --mantine-color-dark-6: #202a37 !important; --mantine-color-dark-7: #151c26 !important;
  }
  :root[data-mantine-color-scheme="light"] {
    --mantine-color-text: #1b2430 !important; --mantine-color-dimmed: #566477 !important;
    --mantine-color-default-border: #c9d2dc !important;
  }`;

// The editor covers the stage. Without a graphics card a frame of it takes a second that the editor needs: its endless round of
// frames, known by being asked for again and again, goes once in two seconds meanwhile. All else in the frame goes on as before.
function restBeneathTheEditor(inside) {
  const [editor, asked, held] = [document.getElementById("editor"), new WeakMap(), new Map()];
  const [next, drop] = [inside.requestAnimationFrame.bind(inside), inside.cancelAnimationFrame.bind(inside)];
  inside.requestAnimationFrame = (step) => {
    asked.set(step, (asked.get(step) ?? 0) + 1);
    if (editor.hidden || asked.get(step) < 20) return next(step);
    const id = -inside.setTimeout(() => held.delete(id) && next(step), 2000);
    held.set(id, step);
    return id;
  };
  inside.cancelAnimationFrame = (id) => (held.delete(id) ? inside.clearTimeout(-id) : drop(id));
  new MutationObserver(() => {
    for (const step of editor.hidden ? held.values() : []) next(step);
    if (editor.hidden) held.clear();
  }).observe(editor, { attributeFilter: ["hidden"] });
}

// viser says for good that there is no graphics card, over our view buttons; a short sentence is enough.
function dismissSlowNotice(paper) {
  for (const title of paper.querySelectorAll(".mantine-Notification-title")) {
    if (!title.textContent.startsWith("Software WebGL")) continue;
    title.closest(".mantine-Notification-root, .mantine-Notifications-notification")?.querySelector("button")?.click();
    toast("No graphics card in use: the stage moves slowly.");
    return true;
  }
  return false;
}
