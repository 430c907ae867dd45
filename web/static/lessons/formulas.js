// Formulas as in the papers, which the server has typeset. Only elements of MathML are taken over, and of those no links and no
// scripts. A symbol that is a parameter leads to it in Tune.

import { $, make } from "../ui/elements.js";

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
