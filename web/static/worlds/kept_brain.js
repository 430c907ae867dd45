// The run that was cut off, or the brain that an earlier program kept: a quiet offer over the plates, until somebody has answered it on any page.

import { $ } from "../ui/elements.js";
import { post } from "../net/post.js";
import { sentence, toast } from "../ui/words.js";

/** @param {number} count */
export const experiences = (count) => `${count.toLocaleString("en")} ${count === 1 ? "experience" : "experiences"}`;

/** The words that offer a kept brain. @param {KeptOffer} kept @param {number} now_s since 1970 */
export function keptWords(kept, now_s) {
  const LONG_AGO_S = 12 * 3600;
  /** @type {Intl.DateTimeFormatOptions} */
  const day = now_s - kept.kept_at < LONG_AGO_S ? {} : { day: "numeric", month: "short", year: "numeric" };
  const when = new Date(kept.kept_at * 1000).toLocaleString("en-GB", { ...day, hour: "2-digit", minute: "2-digit" });
  return `${kept.title}, ${Math.round(kept.time_s / 60)} simulated minutes, ${experiences(kept.experiences)}, kept ${when}`;
}

const LOOK_MS = 400;

export class KeptBrain {
  /** @param {(world: string) => Promise<boolean>} mayLeave whether the office as it is now may be left for that world */
  constructor(mayLeave) {
    this.mayLeave = mayLeave;
    this.box = $("kept");
    this.asked = false;
    /** @type {KeptOffer | null} */
    this.kept = null;
    $("kept-wake").addEventListener("click", () => this.wake());
    /** @type {AbortController | null} */
    this.going = null; // on with a run
    $("kept-cancel").addEventListener("click", () => this.going?.abort());
    $("kept-not-now").addEventListener("click", () => this.answer(false));
    document.addEventListener("visibilitychange", () => !document.hidden && !this.box.hidden && this.look());
  }

  // Called once there is a state; before that, nothing could be woken up.
  ask() {
    if (this.asked) return;
    this.asked = true;
    this.look();
  }

  async look() {
    try {
      this.kept = await (await fetch("/api/brain/kept")).json();
    } catch {
      return; // the connection is lost; what is shown stays
    }
    if (this.kept) this.show(this.kept);
    this.box.hidden = !this.kept;
  }

  /** @param {KeptOffer} kept */
  show(kept) {
    $("kept-words").textContent = keptWords(kept, Date.now() / 1000);
    $("kept-title").textContent = kept.run ? "A run was cut off." : "A brain was kept.";
    $("kept-wake").textContent = kept.run ? "Go on with the run" : "Wake it up";
    $("kept-wake").title = kept.run
      ? "Go on where it was, with its map, its world and its orders"
      : "Begin anew with this brain, in its world and with its seed";
    this.box.setAttribute("aria-label", kept.run ? "A run that was cut off" : "A brain that was kept");
  }

  async wake() {
    if (this.kept && (await this.mayLeave(this.kept.world))) await this.answer(true);
  }

  /** @param {boolean} use */
  async answer(use) {
    if (use && this.kept?.run) return this.goOn(this.kept);
    for (const button of this.box.querySelectorAll("button")) button.disabled = true;
    const { wrong } = await post("/api/brain/kept", { use });
    for (const button of this.box.querySelectorAll("button")) button.disabled = false;
    if (wrong) toast(wrong, { bad: true });
    else if (use && this.kept) toast(`Started anew in ${this.kept.title} with ${experiences(this.kept.experiences)}.`);
    await this.look();
  }

  // What led to where the run was is run again, which takes a while after a long run.
  /** @param {KeptOffer} kept */
  async goOn(kept) {
    this.going = new AbortController();
    const { signal } = this.going;
    this.waits(true);
    const looking = setInterval(() => this.far(), LOOK_MS);
    const { wrong } = await post("/api/brain/kept", { use: true }, signal);
    clearInterval(looking);
    this.going = null;
    this.waits(false);
    if (signal.aborted) toast("The run stays where it was left.");
    else if (wrong) toast(wrong, { bad: true });
    else toast(`The run in ${kept.title} goes on where it was.`);
    await this.look();
  }

  /** @param {boolean} going */
  waits(going) {
    $("kept-wake").hidden = $("kept-not-now").hidden = going;
    $("kept-cancel").hidden = $("kept-done").hidden = !going;
    $("kept-done").removeAttribute("value");
    if (going) $("kept-words").textContent = "What led to where it was is run again.";
  }

  async far() {
    const share = await fetch("/api/brain/kept/done").then(
      (answer) => answer.json(),
      () => null,
    );
    if (share) $("kept-done").value = share;
  }
}

/** The run begins anew with the brain of the file that is chosen. It is sent as it is; the server says in a sentence what is wrong with it. */
export function takeBrainFiles() {
  const input = $("brain-file");
  $("brain-load").addEventListener("click", () => {
    $("restart").open = false;
    input.click();
  });
  input.addEventListener("change", () => {
    if (input.files?.length) send(input.files[0]);
    input.value = ""; // so that the same file can be chosen again
  });
}

/** @param {File} file */
async function send(file) {
  const headers = { "Content-Type": "application/octet-stream" };
  try {
    const answer = await fetch("/api/brain", { method: "POST", headers, body: file });
    const reply = await answer.json();
    if (answer.ok) toast(`Started anew with the brain of ${file.name}.`);
    else for (const wrong of reply.detail) toast(sentence(wrong.reason), { bad: true });
  } catch {
    toast(`${file.name} could not be sent.`, { bad: true });
  }
}
