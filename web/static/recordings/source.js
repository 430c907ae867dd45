// Where the session comes from: an office that is simulated, or a recording. What a recording lacks is not on the page.

import { $, find } from "../ui/elements.js";

const OFFICE_TABS = ["Office"];

export class Source {
  /** @param {import("../panel/panel.js").Panel} panel */
  constructor(panel) {
    this.panel = panel;
    this.shown = "";
    /** @type {RecordingFields | null} */
    this.recording = null;
  }

  /** @param {RecordingFields | null} recording */
  show(recording) {
    this.recording = recording;
    const truth = recording === null || recording.has.includes("truth");
    const now = `${recording?.name} ${truth}`;
    if (now === this.shown) return;
    this.shown = now;
    document.body.dataset.source = recording ? "recording" : "office";
    document.body.dataset.truth = String(truth);
    find(document, 'button[data-view="office"]').textContent = recording ? "True path" : "Office";
    this.panel.hide([...(recording ? OFFICE_TABS : []), ...(truth ? [] : ["Truth"])]);
    $("restart-words").textContent = recording ? "Play from the beginning with seed" : "Restart with seed";
  }

  /** Why an order to the robot or the office is not carried out, or null. */
  get lacks() {
    return this.recording && "A recording plays: it has no office, and its robot goes where it went.";
  }
}
