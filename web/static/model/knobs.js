// Parameters as controls: their groups, their words, and which of them a search finds. No DOM.

/**
 * A parameter as the server sends it (web/panel/tune.py).
 * @typedef {{
 *   name: string, value: number | boolean | string, default: number | boolean | string, symbol: string, unit: string,
 *   low: number | null, high: number | null, step: number | null, choices: string[], live: boolean, hint: string,
 * }} Parameter
 */

/** The name of a parameter within its group. @param {string} name */
export const shortName = (name) => name.slice(name.lastIndexOf(".") + 1).replaceAll("_", " ");

/** The heading of its group. @param {string} name */
export const groupOf = (name) => name.slice(0, Math.max(0, name.lastIndexOf("."))).replaceAll("_", " ") || "all";

/**
 * The parameters by group, in their order.
 * @template {{ name: string }} T
 * @param {T[]} parameters
 * @returns {Map<string, T[]>}
 */
export function grouped(parameters) {
  /** @type {Map<string, T[]>} */
  const groups = new Map();
  for (const parameter of parameters) {
    const group = groupOf(parameter.name);
    groups.set(group, [...(groups.get(group) ?? []), parameter]);
  }
  return groups;
}

/**
 * Whether a search finds this parameter: each word searched for is in its name, symbol, unit or meaning.
 * @param {Pick<Parameter, "name" | "symbol" | "unit" | "hint">} parameter
 * @param {string} search
 */
export function means({ name, symbol, unit, hint }, search) {
  const text = `${name} ${name.replaceAll("_", " ")} ${symbol} ${unit} ${hint}`.toLowerCase();
  return search
    .toLowerCase()
    .split(/\s+/)
    .every((word) => text.includes(word));
}

/** A symbol as it is printed: the part on the line, and the subscript. @param {string} symbol @returns {[string, string]} */
export function printed(symbol) {
  const [base, ...below] = symbol.split("_");
  return [base, below.join("_").replace(/^\{(.*)\}$/, "$1")];
}

/** Whether the value is the default. @param {Pick<Parameter, "value" | "default">} parameter */
export const isDefault = (parameter) => parameter.value === parameter.default;
