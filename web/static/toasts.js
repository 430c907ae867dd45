// Short sentences over the stage: what was refused, what the connection does. Text only, never HTML.

import { icon } from "./icons.js";

const SHOWN_MS = 4500;

export function toast(text, { bad = false, stays = false } = {}) {
  const place = document.getElementById(bad ? "alerts" : "toasts");
  for (const other of place.children) if (other.dataset.text === text) other.remove();
  while (place.children.length > 2) place.firstChild.remove();
  const box = document.createElement("div");
  box.className = bad ? "toast bad" : "toast";
  box.dataset.text = text;
  box.append(icon(bad ? "warn" : "check"), Object.assign(document.createElement("span"), { textContent: text }));
  place.append(box);
  if (!stays) setTimeout(() => box.remove(), SHOWN_MS);
  return box;
}
