// The words of the header: what the session is doing, and the state of the goal. No DOM.

/** @typedef {[icon: string, tone: string, words: string]} Chip */

/** @type {Record<GoalState, Chip>} */
const GOALS = {
  tracking: ["flag", "goal", "going to the goal"],
  coasting: ["flag", "goal", "by dead reckoning"],
  exploring: ["compass", "goal", "looking for a way"],
  arrived: ["check", "goal", "at the goal"],
  unreachable: ["warn", "bad", "no way to the goal"],
};

/**
 * @param {Pick<State, "running" | "mode" | "goal" | "pose_cells">} state
 * @param {Pick<PageFields, "fault" | "lost"> & Partial<Pick<PageFields, "recording" | "situation">> & { time?: TimeFields | null }} page
 * @returns {Chip}
 */
export function statusOf(state, page) {
  if (page.time?.past) return ["clock", "past", state.running ? "the past, played" : "the past"];
  if (page.fault) return ["warn", "bad", state.running ? "in a long tick" : "stopped by a fault"];
  if (page.recording?.over) return ["check", "", "the recording has ended"];
  if (!state.running) return atRest(page);
  const packets = state.pose_cells.packets.length;
  if (page.lost) return ["lost", "lost", packets > 1 ? `lost: ${packets} packets` : "lost"];
  if (page.recording) return ["play", "good", "playing a recording"];
  if (state.mode === "manual") return ["hand", "hand", "driving by hand"];
  if (state.goal && state.mode === "goal") return GOALS[state.goal.state];
  return ["compass", "good", "exploring"];
}

/** @param {Partial<Pick<PageFields, "situation">>} page @returns {Chip} */
const atRest = ({ situation }) =>
  situation?.state === "playing" ? ["play", "good", "playing up to a moment"] : ["pause", "", "paused"];

/** @param {Goal} goal */
export function goalWords({ state, experience, remaining_m, eta_s }) {
  const [icon, , words] = GOALS[state];
  const [ended, ahead] = [state === "arrived" ? "arrived" : "no way", state !== "arrived" && state !== "unreachable"];
  return {
    icon,
    title: `${words}, experience ${experience}`,
    what: ahead ? "goal" : ended,
    metres: ahead && remaining_m !== null ? `${remaining_m.toFixed(remaining_m < 100 ? 1 : 0)} m` : "",
    seconds: ahead && eta_s !== null ? duration(eta_s) : "",
  };
}

/** As the flag on the map says it. @param {number} seconds */
export function duration(seconds) {
  return seconds < 120 ? `${Math.round(seconds)} s` : `${Math.round(seconds / 60)} min`;
}
