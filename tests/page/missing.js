// What the DOM of these tests lacks. Nothing here draws or has a place: each element is as large as the next, and a pen leaves
// no line.

const [WIDTH, HEIGHT] = [1200, 800];
const PEN = new Proxy(() => PEN, { get: () => PEN, set: () => true });
const WITHOUT = ["webgl", "webgl2"];

/** @typedef {Record<string, any>} Inside a page's own window */

/** @param {Inside} inside */
export function complete(inside) {
  if (inside.Path2D) return; // this window has them
  Object.assign(inside, { Path2D: class {}, ImageData: class {}, Option: optionOf(inside), createImageBitmap });
  const { HTMLElement, HTMLTableRowElement, HTMLTableSectionElement, WebSocket } = inside;
  inside.saved = []; // what went down to a file: a Blob each
  inside.URL = class extends inside.URL {
    /** @param {Blob} blob */
    static createObjectURL(blob) {
      inside.saved.push(blob);
      return "javascript:void 0";
    }

    static revokeObjectURL() {}
  };
  inside.sockets = [];
  inside.WebSocket = class extends WebSocket {
    /** @param {string} address */
    constructor(address) {
      super(address);
      inside.sockets.push(this);
    }
  };
  inside.asking = 0; // answers that have not come as a whole
  const { fetch, Response } = inside;
  inside.fetch = async (/** @type {Parameters<typeof globalThis.fetch>} */ ...wish) => {
    inside.asking++;
    try {
      return await Promise.race([whole(fetch.apply(inside, wish), Response), givenUp(wish[1]?.signal ?? undefined)]);
    } finally {
      inside.asking--;
    }
  };
  const { Element, HTMLCanvasElement, DOMRect } = inside;
  for (const [name, value] of [
    ["clientWidth", WIDTH],
    ["clientHeight", HEIGHT],
  ])
    Object.defineProperty(Element.prototype, name, { get: () => value, configurable: true });
  Element.prototype.getBoundingClientRect = () => new DOMRect(0, 0, WIDTH, HEIGHT);
  HTMLCanvasElement.prototype.getContext = (/** @type {string} */ kind) => (WITHOUT.includes(kind) ? null : PEN);
  Element.prototype.setPointerCapture = () => {};
  HTMLElement.prototype.checkVisibility = isVisible; // its own asks style sheets, which are not there
  give(HTMLElement, {
    ariaLabel: { get: getLabel, set: setLabel },
  });
  give(HTMLTableRowElement, { cells: { get: childrenOf } });
  give(HTMLTableSectionElement, {
    rows: { get: childrenOf },
    insertRow: { value: insertRow },
    deleteRow: { value: deleteRow },
  });
}

/** An answer that has come as a whole. @param {Promise<any>} coming @param {any} Response */
async function whole(coming, Response) {
  const answer = await coming;
  const { status, headers } = answer;
  return new Response(status === 204 ? null : await answer.arrayBuffer(), { status, headers });
}

/** Fails when the request is given up, also while its answer is coming. @param {AbortSignal} [signal] */
const givenUp = (signal) =>
  new Promise((_, fail) => signal?.addEventListener("abort", () => fail(signal.reason ?? new Error("aborted"))));

/** @param {any} kind @param {PropertyDescriptorMap} parts those that it has not already */
function give({ prototype }, parts) {
  for (const [name, part] of Object.entries(parts))
    if (!(name in prototype)) Object.defineProperty(prototype, name, part);
}

/** @this {Element} */
function isVisible() {
  return isShown(this);
}

/** @this {Element} */
function getLabel() {
  return this.getAttribute("aria-label");
}

/** @this {Element} @param {string} words */
function setLabel(words) {
  this.setAttribute("aria-label", words);
}

/** As a browser, which cannot read the formats that robots write. @param {Blob} blob */
async function createImageBitmap(blob) {
  if (blob.type !== "image/jpeg") throw new Error("no picture");
  return { close() {} };
}

/** Whether a person would see it, apart from what style sheets say. @param {Element | null} part */
export function isShown(part) {
  if (!part?.isConnected) return false;
  for (let up = /** @type {Element | null} */ (part); up; up = up.parentElement) {
    const closed = up.matches("[hidden], dialog:not([open])");
    const folded = up.parentElement?.matches("details:not([open])") && !up.matches("summary");
    if (closed || folded) return false;
  }
  return true;
}

/** @param {Inside} inside */
function optionOf(inside) {
  /** @param {string} text */
  function Option(text = "", value = text) {
    return Object.assign(inside.document.createElement("option"), { textContent: text, value });
  }
  return Option;
}

/** @this {Element} */
function childrenOf() {
  return this.children;
}

/** @this {Element} */
function insertRow() {
  return this.appendChild(this.ownerDocument.createElement("tr"));
}

/** @this {Element} @param {number} k */
function deleteRow(k) {
  this.children[k < 0 ? this.children.length + k : k].remove();
}
