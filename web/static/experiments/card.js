// One experiment in the gallery: its figure, what it asks, and the buttons.

import { icon, make } from "../ui/elements.js";
import { engineWords, facts, firstEngine } from "../model/experiments.js";
import { planOf } from "./plan.js";

/**
 * @param {Card} card
 * @param {{ watch: (engine: EngineName) => void, trials: (engine: EngineName) => void }} actions
 */
export function cardOf(card, { watch, trials }) {
  const engine = make("select", { title: "By whose rules", ariaLabel: `Engine for ${card.title}` });
  engine.append(...card.engines.map((name) => new Option(engineWords(name), name)));
  engine.value = firstEngine(card);
  const chosen = () => /** @type {EngineName} */ (engine.value);
  const go = make("button", { type: "button", className: "go", ariaLabel: `Watch it: ${card.title}` });
  go.append(icon("play"), "Watch it");
  go.addEventListener("click", () => watch(chosen()));
  const more = make("button", { type: "button", className: "trials", textContent: "Trials" });
  more.ariaLabel = `Trials of ${card.title}`;
  more.addEventListener("click", () => trials(chosen()));
  const row = make("div", { className: "row" }, ...(card.engines.length > 1 ? [engine] : []), go, more);
  const made = make(
    "li",
    { className: "card" },
    figureOf(card),
    make("h3", { textContent: card.title }),
    make("p", { className: "second", textContent: `${card.paper} · ${card.world}` }),
    make("p", { className: "asks", textContent: card.asks }),
    make("p", { className: "second facts", textContent: facts(card) }),
    row,
  );
  made.dataset.name = card.name;
  return made;
}

/** @param {Card} card */
function figureOf({ picture, plan, title }) {
  const figure = make("div", { className: "figure" });
  if (picture) figure.append(make("img", { src: picture, alt: `Figure: ${title}`, loading: "lazy" }));
  else if (plan) figure.append(planOf(plan));
  figure.classList.toggle("drawn", !picture);
  return figure;
}
