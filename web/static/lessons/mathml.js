// Formulas that the server has typeset. Only elements of MathML are taken over, and of those no links and no scripts.

const MATHML = "http://www.w3.org/1998/Math/MathML";

/** @param {string} text @returns {Element} */
export function mathOf(text) {
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
