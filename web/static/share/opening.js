// Opens what somebody else has made of a moment: from the address of the page, from a file, and shows it as they saw it.

import { $, find, setIcon } from "../ui/elements.js";
import { linkIn, situationWords } from "../model/moments.js";
import { post } from "../net/post.js";
import { toast } from "../ui/toasts.js";

const ICONS = /** @type {const} */ ({ playing: "share", same: "check", other: "warn", stopped: "warn" });

export class Opening {
  /**
   * @param {import("../net/connection.js").Connection} link
   * @param {{ mayLeave: () => Promise<boolean>, look: (look: Look) => void }} page
   */
  constructor(link, page) {
    this.link = link;
    this.page = page;
    this.begun = false;
    this.looked = -1; // the run whose look has been taken over
    this.away = -1; // the run whose note was put away
    this.run = -1;
    window.addEventListener("hashchange", () => this.address());
    $("situation-leave").addEventListener("click", () => link.ask({ type: "leave_situation" }));
    $("situation-close").addEventListener("click", () => {
      this.away = this.run;
      $("situation").hidden = true;
    });
  }

  /** A link in the page's address is opened once; then the address is the page's own again, so that a reload changes nothing. */
  async address() {
    const link = linkIn(location.hash);
    if (!link) return;
    history.replaceState(null, "", location.pathname);
    await this.open(link, "The link");
  }

  /** Opens the file if it is a situation. False: it is something else. @param {File} file */
  async offer(file) {
    if (!/\.json$/i.test(file.name) || !(await file.slice(0, 200).text()).includes('"ratslam situation/')) return false;
    await this.open(await file.text(), file.name);
    return true;
  }

  /** @param {string} text @param {string} what */
  async open(text, what) {
    if (!(await this.page.mayLeave())) return;
    const told = await post("/api/situation/open", { text });
    if (told.wrong) toast(`${what} cannot be opened. ${told.wrong}`, { bad: true });
  }

  /** What arrives: how far it is. @param {PageFields} page */
  show({ situation, run }) {
    if (!this.begun) {
      this.begun = true;
      this.address();
    }
    const box = $("situation");
    this.run = run;
    box.hidden = !situation || this.away === run;
    if (!situation) return;
    if (this.looked !== run) {
      this.looked = run;
      this.page.look(situation.look);
    }
    const { title, words, share } = situationWords(situation);
    box.dataset.state = situation.state;
    setIcon(find(box, ".head"), ICONS[situation.state]);
    say(find(box, ".head b"), title);
    say(find(box, ".words"), words);
    const bar = /** @type {HTMLProgressElement} */ (find(box, "progress"));
    const playing = situation.state === "playing";
    bar.hidden = $("situation-leave").hidden = !playing;
    bar.value = share;
  }
}

/** @param {Element} place @param {string} words */
function say(place, words) {
  if (place.textContent !== words) place.textContent = words; // it is read aloud when it changes
}
