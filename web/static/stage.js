// The stage: viser's client in a frame of our own origin, its view buttons, and its panel on a phone.

export const VIEWS = ["all", "office", "pose", "map"];
export const phone = window.matchMedia("(max-width: 760px)");

export class Stage {
  constructor(link, keys) {
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
    inside.addEventListener("focus", () => {});
    this.keys.listen(inside);
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
  }

  // On a phone viser's panel would cover the stage; a button brings it.
  showPanels(on) {
    this.panels = on;
    document.getElementById("panels").setAttribute("aria-pressed", String(on));
    if (this.style) this.style.textContent = on ? "" : HIDE_PANEL;
  }
}

const HIDE_PANEL = "";
