// Formulas as in the papers. A symbol that is a parameter leads to it in Tune.

import { make } from "../ui/elements.js";
import { mathOf } from "./mathml.js";

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
