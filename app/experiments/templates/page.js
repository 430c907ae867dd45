"use strict";
// A box beside what was pressed: what a trial was, and the command that opens it.
const data = JSON.parse(document.getElementById("data").textContent);
const box = document.getElementById("box");
let opener = null;

function element(name, text, className) {
  const made = document.createElement(name);
  if (text) made.textContent = text;
  if (className) made.className = className;
  return made;
}

function pairs(rows) {
  const list = element("dl");
  for (const [key, value] of rows) list.append(element("dt", key), element("dd", value));
  return list;
}

async function copy(button, code) {
  try {
    await navigator.clipboard.writeText(code.textContent);
  } catch {
    getSelection().selectAllChildren(code); // without permission it is at least selected
    document.execCommand("copy");
  }
  button.textContent = "Copied";
}

function commandLine(text) {
  const line = element("div", "", "command");
  const code = element("code", text);
  const button = element("button", "Copy");
  button.addEventListener("click", () => copy(button, code));
  line.append(code, button);
  return line;
}

function fill(facts, extra) {
  const close = element("button", "×", "close");
  close.setAttribute("aria-label", "Close");
  close.addEventListener("click", hide);
  const heading = element("h2", facts.heading);
  heading.id = "box-heading";
  box.replaceChildren(heading, close, element("div", facts.levels), pairs(facts.scores), ...extra);
}

function trial(id) {
  const facts = data.trials[id];
  fill(facts, [element("div", `Decided: ${facts.moment}`), commandLine(facts.command)]);
}

function cell(number) {
  const facts = data.cells[number];
  const list = element("ul", "", "plain");
  for (const id of facts.trials) {
    const item = element("li");
    item.append(commandLine(data.trials[id].command));
    list.append(item);
  }
  fill(facts, [list]);
}

function hide() {
  if (!box.open) return;
  box.close();
  if (opener) opener.focus({ preventScroll: true });
}

function show(target) {
  opener = target;
  if (target.dataset.trial) trial(target.dataset.trial);
  else cell(target.dataset.cell);
  if (!box.open) box.show();
  const at = target.getBoundingClientRect();
  const left = Math.min(Math.max(16, at.left), innerWidth - box.offsetWidth - 16);
  const below = at.bottom + 8;
  const top = below + box.offsetHeight < innerHeight ? below : Math.max(16, at.top - box.offsetHeight - 8);
  box.style.left = `${Math.max(16, left)}px`;
  box.style.top = `${Math.min(top, Math.max(16, innerHeight - box.offsetHeight - 16))}px`;
}

document.addEventListener("click", (event) => {
  const target = event.target.closest("[data-trial], [data-cell]");
  if (target) show(target);
  else if (!box.contains(event.target)) hide();
});
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape") hide();
  const target = event.target.closest("svg [data-trial], svg [data-cell]");
  if (target && (event.key === "Enter" || event.key === " ")) {
    event.preventDefault();
    show(target);
  }
});
