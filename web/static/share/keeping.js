// The menu beside the views: what can be kept of the moment that is shown, and shared. It also opens what others have shared.

import { $, find } from "../ui/elements.js";
import { Opening, Share } from "./share.js";
import { naming, StageFilm } from "./stage_film.js";
import { reasons } from "../net/post.js";
import { savePng, saveSvg } from "./pictures.js";
import { toast } from "../ui/toasts.js";

export class Keeping {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {{ viewer: import("../viewer/viewer.js").Viewer, panel: import("../panel/panel.js").Panel,
   *   files: import("../worlds/files.js").Files, timeline: import("../timeline/timeline.js").Timeline, mayLeave: () => Promise<boolean> }} page
   */
  constructor(link, { viewer, panel, files, timeline, mayLeave }) {
    const share = new Share(() => ({ plate: viewer.view, tab: panel.opened, page: link.page }));
    /** @param {Look} look */
    const look = ({ plate, tab, camera }) => {
      viewer.show(plate, camera);
      if (tab) panel.open(tab);
    };
    this.opening = new Opening(link, { mayLeave, look });
    timeline.bookmarks.share = () => share.link();
    files.taken = (file) => this.opening.offer(file);
    this.film = new StageFilm(link, timeline);
    this.on("keep-stage", () => this.film.picture());
    this.on("keep-film", () => this.film.begin());
    /** @type {NodeListOf<HTMLElement>} */
    const plates = $("keep").querySelectorAll("[data-plate]");
    for (const button of plates) this.does(button, () => savePlate(button.dataset.plate ?? "", button.dataset.kind));
    this.on("keep-link", () => share.link());
    this.on("keep-file", () => share.file());
    this.on("keep-python", () => share.python());
  }

  /** @param {State} state @param {PageFields} page */
  show(state, page) {
    naming(state);
    const second = state.beside?.second.name;
    offer("keep-pose-2", second && `Pose cells: ${second}`);
    offer("keep-map-2", second && `Experience map: ${second}`);
    this.opening.show(page);
    this.film.at(state, page);
  }

  /** @param {keyof IndexIds} id @param {() => unknown} action */
  on(id, action) {
    this.does(/** @type {HTMLElement} */ ($(id)), action);
  }

  /** @param {HTMLElement} button @param {() => unknown} action */
  does(button, action) {
    button.addEventListener("click", () => {
      $("keep").open = false;
      action();
    });
  }
}

/**
 * A plate of the second brain under its name; without one there is none.
 * @param {"keep-pose-2" | "keep-map-2"} id @param {string | undefined} words
 */
function offer(id, words) {
  const row = $(id);
  row.hidden = !words;
  if (!words || row.ariaLabel === words) return;
  row.ariaLabel = find(row, "span").textContent = words;
  for (const button of row.querySelectorAll("button")) button.ariaLabel = `${words} as ${button.textContent}`;
}

/** @param {string} plate @param {string} [kind] */
async function savePlate(plate, kind) {
  const theme = document.documentElement.dataset.theme === "light" ? "light" : "dark";
  try {
    const answer = await fetch(`/api/picture/${plate}?theme=${theme}`);
    const save = kind === "png" ? savePng : saveSvg;
    if (answer.ok) await save(await answer.text(), plate.replace("_", "-"));
    else toast(reasons(await answer.json()), { bad: true });
  } catch {
    toast("The connection is lost; the picture was not made.", { bad: true });
  }
}
