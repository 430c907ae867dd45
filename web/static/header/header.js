// The header: what the session is doing, the controls for time, world and goal, its menus, and light or dark.

import { $, find, keep, kept, setIcon } from "../ui/elements.js";
import { clock, sentence, toast } from "../ui/words.js";
import { THEMES } from "../shared.js";

/** Those that drop down. @returns {HTMLDetailsElement[]} */
const menus = () => [...document.querySelectorAll(/** @type {"details"} */ ("details.menu"))];

/** @param {HTMLDetailsElement} menu */
export function closeMenu(menu) {
  menu.open = false;
  find(menu, "summary").focus();
}

// True when one was open.
export function closeOpenMenu() {
  const menu = menus().find(({ open }) => open);
  if (menu) closeMenu(menu);
  return menu !== undefined;
}

export class Header {
  constructor() {
    this.worlds = "";
    /** @type {string | null} */
    this.fault = null;
    /** @type {HTMLElement | null} */
    this.faultToast = null;
    window.addEventListener("click", ({ target }) => {
      for (const menu of menus()) if (!menu.contains(/** @type {Node} */ (target))) menu.open = false;
    });
  }

  /** @param {State} state @param {PageFields} page */
  show(state, page) {
    $("clock").textContent = clock(state.time_s);
    $("clock").title = `Simulated time, now ${page.real_time_factor.toFixed(1)} times as fast as real time`;
    const playing = state.running;
    setIcon($("play"), playing ? "pause" : "play");
    $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    $("play").title = playing ? "Pause (space)" : "Play (space)";
    if (document.activeElement !== $("speed")) choose($("speed"), String(state.speed));
    $("explore").disabled = state.mode === "explore" || state.mode === "recorded";
    $("seed").textContent = String(state.seed);
    this.showWorlds(state.world, page);
    this.showStatus(page);
    this.showGoal(page.status.goal);
    this.showWalk(page.walk);
    this.showFault(page.fault, state.running);
  }

  // Before the first tick there is no state, but much to do.
  /** @param {string} doing */
  waking(doing) {
    find($("status"), "span").textContent = doing;
  }

  // A recording stands before the worlds, under no name that could be chosen.
  /** @param {string | null} world @param {PageFields} page */
  showWorlds(world, { worlds, recording }) {
    const text = JSON.stringify([worlds, recording?.name]);
    if (text !== this.worlds) {
      this.worlds = text;
      const played = recording ? [new Option(recording.name, "")] : [];
      $("world").replaceChildren(...played, ...worlds.map(([name, title]) => new Option(title, name)));
      $("world").title = recording ? `Recording: ${recording.format}, with ${recording.has.join(", ")}` : "World";
    }
    if (document.activeElement !== $("world")) $("world").value = world ?? "";
  }

  /** @param {PageFields} page */
  showStatus(page) {
    const { icon, tone, words: text } = page.status.robot;
    const chip = $("status");
    setIcon(chip, icon);
    chip.dataset.tone = tone;
    chip.title = page.doing;
    const words = find(chip, "span");
    if (words.textContent !== text) words.textContent = text; // only when it changes, since it is then read aloud
  }

  // A fault has too many words for a chip.
  /** @param {string | null} fault @param {boolean} goesOn */
  showFault(fault, goesOn) {
    if (fault === this.fault) return;
    this.fault = fault;
    this.faultToast?.remove();
    const words = goesOn ? `In a long tick: ${fault}` : `Stopped by a fault. ${fault}`;
    this.faultToast = fault ? toast(words, { bad: true, stays: true }) : null;
  }

  // One tick, stage by stage.
  /** @param {Walk | null} walk */
  showWalk(walk) {
    const box = $("walk");
    box.hidden = !walk;
    if (!walk) return;
    find(box, ".which").textContent = `${walk.at} of ${walk.of}`;
    $("walk-back").disabled = walk.at === 1;
    $("walk-next").textContent = walk.at === walk.of ? "Next tick" : "Next stage";
    const title = find(box, ".title");
    if (title.textContent === walk.title && find(box, ".words").textContent === walk.words) return;
    title.textContent = walk.title; // only when it changes, since it is then read aloud
    find(box, ".words").textContent = walk.words;
  }

  /** @param {GoalChip | null} goal */
  showGoal(goal) {
    const chip = $("goal");
    chip.hidden = goal === null;
    if (goal === null) return;
    setIcon(chip, goal.icon);
    chip.title = sentence(goal.words);
    find(chip, ".what").textContent = goal.short;
    find(chip, ".what").classList.toggle("always", !goal.metres && !goal.seconds);
    find(chip, ".metres").textContent = goal.metres;
    find(chip, ".seconds").textContent = goal.seconds;
  }
}

/** @param {HTMLSelectElement} select @param {string} value */
function choose(select, value) {
  if (![...select.options].some((option) => option.value === value)) select.add(new Option(`× ${value}`, value));
  select.value = value;
}

/** Light or dark. The choice is each viewer's own: the server shows this page the plates of its theme. */
export class Theming {
  /** @param {import("../net/connection.js").Connection} link */
  constructor(link) {
    this.link = link;
    this.show(firstTheme());
  }

  /** @returns {Theme} */
  get name() {
    return document.documentElement.dataset.theme === "light" ? "light" : "dark";
  }

  /** @param {Theme} name */
  show(name) {
    document.documentElement.dataset.theme = name;
    setIcon($("theme"), name === "dark" ? "sun" : "moon");
    $("theme").setAttribute("aria-label", name === "dark" ? "Light colours" : "Dark colours");
    this.tell();
  }

  /** Shown are the plates of its theme, without motions of their own where the system asks for few. */
  tell() {
    const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.link.send({ type: "theme", name: this.name, still });
  }

  toggle() {
    const other = this.name === "dark" ? "light" : "dark";
    this.show(other);
    keep("theme", other);
  }
}

/** The theme chosen earlier in this browser, else the system's. @returns {Theme} */
function firstTheme() {
  const preferred = window.matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark";
  return THEMES.find((name) => name === kept("theme")) ?? preferred;
}
