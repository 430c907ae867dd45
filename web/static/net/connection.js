// The page's websocket: it reconnects by itself, hands out what arrives, sends commands and matches their answers. A page that only
// looks on, `/?watch`, for a second screen, shows what the main page shows and steers nothing; what steers is hidden or disabled there,
// and refused by the server.

import { LOOKS } from "../shared.js";
import { $ } from "../ui/elements.js";

/** Whether a message concerns the page alone. @param {string} kind */
export const isLook = (kind) => /** @type {readonly string[]} */ (LOOKS).includes(kind);

/** @type {ReadonlySet<import("../ui/keys.js").Act>} */
export const WATCHER_KEYS = new Set([
  "view1",
  "view2",
  "view3",
  "view4",
  "follow",
  "panel",
  "theme",
  "present",
  "escape",
]);

const WATCHER = "watch-";

/** A page's own id, which nobody can guess. The server knows by it that a page only looks on. @param {boolean} watching */
export function newId(watching) {
  const bytes = [...crypto.getRandomValues(new Uint8Array(16))].map((byte) => byte.toString(16).padStart(2, "0"));
  return (watching ? WATCHER : "") + bytes.join("");
}

/** @param {string} page */
export const looksOn = (page) => page.startsWith(WATCHER);

/** Makes this page one that only looks on. @param {string} page its id */
export function onlyLook(page) {
  document.title = "RatSLAM, to watch";
  $("world").disabled = true;
  $("timeline").setAttribute("aria-readonly", "true");
  takeNoFiles(window);
  const plain = window.fetch.bind(window);
  window.fetch = (what, how = {}) => plain(what, { ...how, headers: { ...how.headers, "X-Page": page } });
}

/** What is dropped here is neither opened nor shown instead of the page. @param {Window} place */
export function takeNoFiles(place) {
  for (const kind of /** @type {const} */ (["dragenter", "dragover", "drop"]))
    place.addEventListener(
      kind,
      (event) => {
        event.preventDefault();
        event.stopImmediatePropagation();
        if (event.dataTransfer) event.dataTransfer.dropEffect = "none";
      },
      true,
    );
}

const KINDS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array, f4: Float32Array };

/**
 * One array: numbers in their shape, or a picture that the browser has to unpack.
 * @typedef {{ kind: "u1" | "u2" | "u4" | "f4", shape: number[], values: Uint8Array | Uint16Array | Uint32Array | Float32Array }} Numbers
 * @typedef {{ kind: "jpeg", shape: number[], values: Uint8Array<ArrayBuffer> }} Jpeg
 * @typedef {Numbers | Jpeg} Parcel
 */

/**
 * @param {ArrayBuffer} buffer
 * @returns {any} the head with its arrays by name, each a Parcel
 */
export function unframed(buffer) {
  const start = 4 + new DataView(buffer).getUint32(0, true);
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, start - 4)));
  /** @type {Record<string, Parcel>} */
  const arrays = {};
  let at = start;
  for (const { name, kind, shape, bytes } of head.arrays) {
    const Kind = KINDS[/** @type {keyof typeof KINDS} */ (kind)] ?? Uint8Array;
    const values = /** @type {any} */ (new Kind(buffer, at, bytes / Kind.BYTES_PER_ELEMENT));
    arrays[name] = { kind, shape, values };
    at += Math.ceil(bytes / 4) * 4;
  }
  return { ...head, arrays };
}

const RETRY_MS = [150, 400, 800, 1000];

export class Connection extends EventTarget {
  /** @param {string} page this page's own id */
  constructor(page) {
    super();
    this.page = page;
    this.watches = looksOn(page); // it only looks on: whatever steers is not even sent
    this.open = false;
    /** @type {Map<number, { resolve: (answer: Answer) => void, quiet: boolean }>} */
    this.waiting = new Map(); // by the id of the command
    this.lastId = 0;
    this.tries = 0;
    this.socket = this.connect();
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/api/stream?got=1&page=${this.page}`);
    socket.binaryType = "arraybuffer"; // for parts of the panel with arrays
    const slow = setTimeout(() => socket.close(), 3000);
    socket.onopen = () => {
      clearTimeout(slow);
      this.tries = 0;
      this.open = true;
    };
    socket.onmessage = (event) => {
      const message = typeof event.data === "string" ? JSON.parse(event.data) : unframed(event.data);
      if (message.type === "answer") this.settle(message);
      else this.dispatchEvent(new CustomEvent(message.type, { detail: message }));
      if (message.type === "state") this.send({ type: "got" }); // asks for the next, which is the newest by then
    };
    socket.onclose = () => {
      clearTimeout(slow);
      const was = this.open;
      this.open = false;
      for (const { resolve } of this.waiting.values()) resolve({ accepted: false, detail: [] });
      this.waiting.clear();
      if (was) this.dispatchEvent(new Event("lost"));
      setTimeout(
        () => {
          this.socket = this.connect();
        },
        RETRY_MS[Math.min(this.tries++, RETRY_MS.length - 1)],
      );
    };
    return socket;
  }

  /** @param {Answer} answer */
  settle(answer) {
    const { id = 0 } = answer;
    const waiting = this.waiting.get(id);
    this.waiting.delete(id);
    if (!answer.accepted && !waiting?.quiet) this.dispatchEvent(new CustomEvent("refused", { detail: answer }));
    waiting?.resolve(answer);
  }

  /**
   * Calls `take` with the content of each message of a kind.
   * @template T
   * @param {string} kind
   * @param {(detail: T) => void} take
   */
  on(kind, take) {
    this.addEventListener(kind, (event) => take(/** @type {CustomEvent<T>} */ (event).detail));
  }

  /**
   * Fire and forget, for what is sent often or concerns this page alone. Only a refusal is answered.
   * @param {(Command | PageMessage) & { id?: number }} command
   */
  send(command) {
    const goes = this.open && (!this.watches || isLook(command.type));
    if (goes) this.socket.send(JSON.stringify(command));
    return goes;
  }

  /**
   * Resolves to the answer; never rejects. quiet: the caller reports a refusal itself.
   * @param {Command | PageMessage} command
   * @returns {Promise<Answer>}
   */
  ask(command, { quiet = false } = {}) {
    const id = ++this.lastId;
    if (!this.send({ ...command, id })) return Promise.resolve({ accepted: false, detail: [] });
    return new Promise((resolve) => this.waiting.set(id, { resolve, quiet }));
  }
}
