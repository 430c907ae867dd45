// The header: what the session does, and the controls of time, world and goal.

import { setIcon } from "./icons.js";
import { phone } from "./stage.js";
import { clock } from "./timeline.js";

const $ = (id) => document.getElementById(id);
const GOAL_STATES = {
  tracking: ["flag", "goal", "going to the goal"],
  coasting: ["flag", "goal", "going to the goal by dead reckoning"],
  exploring: ["compass", "goal", "looking for a way to the goal"],
  arrived: ["check", "goal", "arrived"],
  unreachable: ["warn", "bad", "no way to the goal"],
};

export class Header {
  constructor() {
    this.worlds = "";
  }

  show(state, page) {
    $("clock").textContent = clock(state.time_s);
    $("clock").title = `Simulated time, now ${page.real_time_factor.toFixed(1)} times as fast as real time`;
    const playing = state.running;
    setIcon($("play"), playing ? "pause" : "play");
    $("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    $("play").title = playing ? "Pause (space)" : "Play (space)";
    if (document.activeElement !== $("speed")) choose($("speed"), String(state.speed));
    $("seed").textContent = state.seed;
    this.showWorlds(state.world, page.worlds);
    this.showStatus(state, page);
    this.showGoal(state.goal);
    this.showWalk(page.walk);
  }

  showWorlds(world, worlds) {
    const text = JSON.stringify(worlds);
    if (text !== this.worlds) {
      this.worlds = text;
      $("world").replaceChildren(...worlds.map(([name, title]) => new Option(title, name)));
    }
    if (document.activeElement !== $("world")) $("world").value = world;
  }

  showStatus(state, page) {
    const [icon, tone, text] = status(state, page);
    const chip = $("status");
    setIcon(chip, icon);
    chip.dataset.tone = tone;
    chip.title = page.doing;
    const words = chip.querySelector("span");
    if (words.textContent !== text) words.textContent = text; // a changed text is read aloud: only then
  }

  // One tick, stage by stage.
  showWalk(walk) {
    const box = $("walk");
    box.hidden = !walk;
    if (!walk) return;
    box.querySelector(".which").textContent = `${walk.at} of ${walk.of}`;
    $("walk-back").disabled = walk.at === 1;
    $("walk-next").textContent = walk.at === walk.of ? "Next tick" : "Next stage";
    const title = box.querySelector(".title");
    if (title.textContent === walk.title && box.querySelector(".words").textContent === walk.words) return;
    title.textContent = walk.title; // a changed text is read aloud: only then
    box.querySelector(".words").textContent = walk.words;
  }

  showGoal(goal) {
    const chip = $("goal");
    chip.hidden = goal === null;
    if (goal === null) return;
    const [icon, , text] = GOAL_STATES[goal.state] ?? GOAL_STATES.tracking;
    setIcon(chip, icon);
    chip.title = `${text}, experience ${goal.experience}`;
    chip.querySelector(".what").textContent = { arrived: "arrived", unreachable: "no way" }[goal.state] ?? "goal";
    const ahead = goal.state !== "arrived" && goal.state !== "unreachable";
    const metres = ahead && goal.remaining_m !== null ? `${goal.remaining_m.toFixed(1)} m` : "";
    const seconds = ahead && goal.eta_s !== null ? `${Math.round(goal.eta_s)} s` : "";
    chip.querySelector(".what").classList.toggle("always", !metres && !seconds);
    chip.querySelector(".metres").textContent = metres;
    chip.querySelector(".seconds").textContent = seconds;
  }
}

function status(state, page) {
  if (page.fault) return ["warn", "bad", `stopped: ${page.fault}`];
  if (!state.running) return ["pause", "", "paused"];
  const packets = state.pose_cells.packets.length;
  const compete = phone.matches ? "" : " compete";
  if (page.lost) return ["lost", "lost", packets > 1 ? `lost: ${packets} packets${compete}` : "lost"];
  if (state.mode === "manual") return ["hand", "hand", "driving by hand"];
  if (state.goal) return GOAL_STATES[state.goal.state] ?? GOAL_STATES.tracking;
  return ["compass", "good", "exploring"];
}

function choose(select, value) {
  if (![...select.options].some((option) => option.value === value)) select.add(new Option(`× ${value}`, value));
  select.value = value;
}
