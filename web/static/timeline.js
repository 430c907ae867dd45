// The timeline: what happened when, as marks of different shape and colour, with names where there is room.

import { svg } from "./icons.js";

const NAMES = {
  snap: "snap", kidnap: "kidnap", recovered: "recovered", goal: "goal set", arrived: "arrived", lost: "lost",
  link: "link lost", place: "places", fault: "fault", parameter: "setting", false: "false positive",
  office: "office", warning: "note", packet: "packet", brain: "brain",
};
const WEIGHT = {
  fault: 6, kidnap: 5, arrived: 4, goal: 4, recovered: 3, lost: 3, link: 2, warning: 2, place: 1, parameter: 1, false: 1,
  office: 1, packet: 2, brain: 3,
};
const STEPS_S = [10, 30, 60, 120, 180, 300, 600, 900, 1800, 3600, 7200, 14400];
const REDRAW_MS = 500;

export function clock(seconds) {
  const whole = Math.floor(seconds);
  const two = (value) => String(value).padStart(2, "0");
  const [hours, minutes] = [Math.floor(whole / 3600), Math.floor(whole / 60) % 60];
  return hours ? `${hours}:${two(minutes)}:${two(whole % 60)}` : `${minutes}:${two(whole % 60)}`;
}

export class Timeline {
  constructor() {
    this.place = document.getElementById("timeline");
    this.list = document.getElementById("events");
    this.events = [];
    this.time_s = 0;
    this.due = null;
    new ResizeObserver(() => this.redraw(true)).observe(this.place);
  }

  add({ fresh, events }) {
    this.events = fresh ? events : this.events.concat(events);
    this.list.replaceChildren(...this.events.slice(-12).map((event) => {
      const item = document.createElement("li");
      item.textContent = `${clock(event.time_s)} ${NAMES[event.kind] ?? event.kind}: ${event.text}`;
      return item;
    }));
    this.redraw(true);
  }

  at(time_s) {
    this.time_s = time_s;
    this.redraw(false);
  }

  redraw(now) {
    if (this.due && !now) return;
    clearTimeout(this.due);
    if (now) this.draw();
    this.due = setTimeout(() => {
      this.due = null;
      if (!now) this.draw();
    }, REDRAW_MS);
  }

  draw() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width) return;
    const end = Math.max(60, this.time_s * 1.03);
    const x = (time_s) => 6 + ((width - 12) * time_s) / end;
    const y = height * 0.52;
    const parts = [line(x(0), x(end), y, "rest"), line(x(0), x(this.time_s), y, "done"), ...this.ticks(x, y, end, width)];
    parts.push(...this.marks(x, y), ...this.labels(x, y, width));
    parts.push(svg("path", { d: `M${x(this.time_s)} ${y - 12}v25`, class: "now" }));
    this.place.replaceChildren(...parts);
    this.place.setAttribute("aria-label", `Timeline: ${clock(this.time_s)}, ${this.events.length} events`);
  }

  ticks(x, y, end, width) {
    const most = Math.max(3, Math.floor(width / 110));
    const step = STEPS_S.find((value) => end / value <= most) ?? Math.ceil(end / most / 3600) * 3600;
    const ticks = [];
    for (let time = 0; time <= end - step * 0.2; time += step) {
      const anchor = time === 0 ? "start" : "middle";
      ticks.push(svg("text", { x: time === 0 ? 0 : x(time), y: y + 28, class: "tick", "text-anchor": anchor }, clock(time)));
    }
    return ticks;
  }

  marks(x, y) {
    const marks = [];
    const taken = new Map(); // kind -> last drawn x: more than one mark in 5 pixels says nothing
    for (const event of this.events) {
      const at = x(event.time_s);
      if (at - (taken.get(event.kind) ?? -99) < 5) continue;
      taken.set(event.kind, at);
      const mark = svg("path", { d: shape(event.kind, at, y), class: event.kind });
      mark.append(svg("title", {}, `${clock(event.time_s)} ${NAMES[event.kind] ?? event.kind}: ${event.text}`));
      marks.push([WEIGHT[event.kind] ?? 0, mark]);
    }
    return marks.sort((a, b) => a[0] - b[0]).map((pair) => pair[1]);
  }

  labels(x, y, width) {
    const free = []; // [from, to] already written on
    const wanted = this.events.filter((event) => WEIGHT[event.kind] > 1).slice(-60);
    wanted.sort((a, b) => WEIGHT[b.kind] - WEIGHT[a.kind] || b.time_s - a.time_s);
    const labels = [];
    for (const event of wanted) {
      const half = NAMES[event.kind].length * 3.6 + 5;
      const at = Math.max(half, Math.min(width - half, x(event.time_s)));
      if (free.some(([from, to]) => at - half < to && at + half > from)) continue;
      free.push([at - half, at + half]);
      labels.push(svg("text", { x: at, y: y - 16, class: `label ${event.kind}`, "text-anchor": "middle" }, NAMES[event.kind]));
    }
    return labels;
  }
}

function line(from, to, y, kind) {
  return svg("path", { d: `M${from} ${y}H${Math.max(from, to)}`, class: kind });
}

function shape(kind, x, y) {
  const circle = (r) => `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
  switch (kind) {
    case "kidnap": return `M${x} ${y - 7}l6 7-6 7-6-7z`;
    case "goal": return `M${x - 4} ${y + 7}v-15l10 4-8.4 4v7z`;
    case "arrived": return `M${x - 6} ${y}l4 5 8-10`;
    case "lost": return `M${x - 5} ${y - 5}l10 10M${x + 5} ${y - 5}l-10 10`;
    case "link": return `M${x - 4} ${y - 4}l8 8M${x + 4} ${y - 4}l-8 8`;
    case "recovered": return circle(5);
    case "fault": return `M${x} ${y - 8}l8 14h-16z`;
    case "warning": return `M${x} ${y - 8}l8 14h-16z`;
    case "office":
    case "parameter": return `M${x} ${y - 6}v12`;
    default: return circle(5);
  }
}
