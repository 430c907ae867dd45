// The real page on the real program, in a DOM without a picture: what is said, offered and done, a hundred times as quick as
// in a browser. What only a browser has (places, focus that Tab moves, canvases, the stage) is tested in tests/e2e.

import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { complete, isShown } from "./missing.js";
import { begin, until, url } from "./program.js";

const { Browser } = createRequire(import.meta.url)("happy-dom"); // by its own types it does not fit to those of node
const NO_STAGE = "<!doctype html><p>no stage</p>";
const CODES = { " ": "Space", ".": "Period", ",": "Comma" };

/** One tab of a browser, for as long as `use` takes. Nothing may have gone wrong in it.
 * @param {(page: Page) => Promise<unknown>} use
 * @param {{ path?: string, base?: string, first?: boolean, kept?: Record<string, string>, expects?: RegExp }} [options]
 *   base: another address than the program's; first: as on a first visit, which is welcomed; kept: what the browser has kept; expects: what may go wrong */
export async function open(use, { path = "", base = url, first = false, kept = {}, expects } = {}) {
  /** @type {string[]} */
  const wrong = [];
  let closing = false; // what is under way then is broken off
  const hear = (/** @type {any[]} */ ...words) =>
    closing || wrong.push(words.map((word) => word?.stack ?? word).join(" "));
  const browser = new Browser({
    console: { ...console, error: hear },
    settings: {
      enableJavaScriptEvaluation: true,
      enableIframePageLoading: true,
      suppressInsecureJavaScriptEnvironmentWarning: true,
      disableCSSFileLoading: true,
      handleDisabledFileLoadingAsSuccess: true,
      fetch: {
        interceptor: {
          beforeAsyncRequest: async (/** @type {any} */ { request, window }) => answered(request, window),
        },
      },
    },
  });
  const answered = (/** @type {any} */ request, /** @type {any} */ window) => {
    complete(window);
    if (request.method === "POST") request.headers.set("Origin", window.location.origin); // as each browser does
    if (!first) window.localStorage.setItem("first minute", "seen");
    if (!window.localStorage.getItem("level")) window.localStorage.setItem("level", "lab");
    for (const [name, value] of Object.entries(kept)) window.localStorage.setItem(name, value);
    if (new URL(request.url).pathname.startsWith("/viser"))
      return new window.Response(NO_STAGE, { headers: { "Content-Type": "text/html" } });
  };
  const tab = browser.newPage();
  try {
    await tab.goto(base + path);
    const page = new Page(tab.mainFrame.window);
    if (page.find("#timeline")) await until("it is alive", () => page.document.body.dataset.alive);
    await use(page);
  } catch (failure) {
    throw wrong.length ? new Error(`${failure}; what went wrong before: ${wrong.join("\n")}`) : failure;
  } finally {
    closing = true;
    const { window } = /** @type {any} */ (tab.mainFrame);
    for (const socket of window.sockets) socket.onmessage = socket.onclose = null; // who closes a tab hears no more of it
    await until("it asks for nothing more", () => window.asking === 0);
    await new Promise((go) => setTimeout(go, 10));
    await browser.close();
  }
  assert.deepEqual(
    wrong.filter((words) => !expects?.test(words)),
    [],
  );
}

/** The main page of a program that has just been started. @param {Parameters<typeof open>[0]} use @param {Parameters<typeof open>[1]} [options] */
export async function fresh(use, options) {
  await begin();
  await open(use, options);
}

export class Page {
  /** @param {any} window */
  constructor(window) {
    this.window = window;
    /** @type {Document} */
    this.document = window.document;
    /** @type {Set<string>} */
    this.toasted = new Set(); // toasts disappear after some seconds
    const look = () => {
      for (const toast of this.all(".toast")) this.toasted.add(toast.textContent);
    };
    for (const box of this.all("#toasts, #alerts")) new window.MutationObserver(look).observe(box, { childList: true });
  }

  /** @param {string} selector */
  find(selector) {
    return /** @type {any} */ (this.document.querySelector(selector));
  }

  /** @param {string} selector */
  all(selector) {
    return /** @type {any[]} */ ([...this.document.querySelectorAll(selector)]);
  }

  /** What a person reads there. @param {string} selector */
  text(selector) {
    return this.find(selector)?.textContent ?? "";
  }

  /** @param {string} selector */
  shown(selector) {
    return isShown(this.find(selector));
  }

  /** Lets the page hear a message as if the server had sent it. @param {object} message */
  hear(message) {
    this.window.sockets.at(-1).onmessage({ data: JSON.stringify(message) });
  }

  /** Changes what a route answers. @param {string} path @param {(told: any) => unknown} change */
  answers(path, change) {
    const { fetch, Response } = this.window;
    this.window.fetch = async (/** @type {string} */ asked, /** @type {any} */ how) => {
      const answer = await fetch(asked, how);
      return asked === path ? new Response(JSON.stringify(change(await answer.json()))) : answer;
    };
  }

  /** Keeps back what the page sends, if it fits: each comes as a function that sends it. @param {(sent: any) => boolean} fits */
  holds(fits) {
    const socket = this.window.sockets.at(-1);
    const send = socket.send.bind(socket);
    /** @type {(() => void)[]} */
    const held = [];
    socket.send = (/** @type {string} */ text) => (fits(JSON.parse(text)) ? held.push(() => send(text)) : send(text));
    return held;
  }

  /** Waits until it says so. @param {string} selector @param {string | RegExp} words */
  says(selector, words) {
    const fits = () =>
      typeof words === "string" ? this.text(selector).includes(words) : words.test(this.text(selector));
    return until(`${selector} says ${words}`, fits).catch((late) => {
      throw new Error(`${late.message}; it says ${this.text(selector)}`);
    });
  }

  /** Waits until a toast has said this, even if it has disappeared again. @param {string} words */
  told(words) {
    return until(`a toast says ${words}`, () => [...this.toasted].some((said) => said.includes(words)));
  }

  /** Waits until it can be pressed, and presses it as a mouse does. @param {string | HTMLElement} part @param {string} [words] what stands on it */
  async click(part, words) {
    const one = () => {
      if (typeof part !== "string") return part;
      return words === undefined ? this.find(part) : this.all(part).find((each) => each.textContent.includes(words));
    };
    await until(`${part} ${words ?? ""} can be pressed`, () => isShown(one()) && !one().disabled);
    const target = one();
    target.focus();
    const { MouseEvent, PointerEvent } = this.window;
    for (const type of ["pointerdown", "pointerup"]) target.dispatchEvent(new PointerEvent(type, { bubbles: true }));
    target.dispatchEvent(new MouseEvent("click", { bubbles: true, cancelable: true, composed: true, detail: 1 }));
  }

  /** A button by what it is called. @param {string} name @param {string} [where] */
  button(name, where = "body") {
    const called = (/** @type {any} */ part) => part.getAttribute("aria-label") ?? part.textContent.trim();
    return this.all(`${where} :is(button, [role=tab], summary)`).find(
      (part) => isShown(part) && called(part).startsWith(name),
    );
  }

  /** Waits until there is a button of this name, and presses it. @param {string} name @param {string} [where] */
  async push(name, where) {
    await this.click(await until(`there is a button ${name}`, () => this.button(name, where)));
  }

  /** Draws a pointer over a part. All parts are 1200 x 800 pixels here. @param {string} selector @param {[number, number][]} points @param {() => void} [held] before it is let go */
  drag(selector, points, held = () => {}) {
    const target = this.find(selector);
    const point = (/** @type {string} */ type, /** @type {[number, number]} */ [clientX, clientY]) =>
      target.dispatchEvent(new this.window.PointerEvent(type, { clientX, clientY, pointerId: 1, bubbles: true }));
    point("pointerdown", points[0]);
    for (const at of points.slice(1)) point("pointermove", at);
    held();
    point("pointerup", /** @type {[number, number]} */ (points.at(-1)));
  }

  /** A tab of the panel. @param {string} name */
  async tab(name) {
    await this.click(`#tab-${name.toLowerCase()}`);
    return `#panel-${name.toLowerCase()}`;
  }

  /** A key, as on an English keyboard, wherever the focus is. @param {string} key @param {{ shift?: boolean, ctrl?: boolean }} [with_] */
  press(key, with_) {
    this.down(key, with_);
    this.up(key, with_);
  }

  /** @param {string} key @param {{ shift?: boolean, ctrl?: boolean }} [with_] */
  down(key, with_) {
    this.key("keydown", key, with_);
  }

  /** @param {string} key @param {{ shift?: boolean, ctrl?: boolean }} [with_] */
  up(key, with_) {
    this.key("keyup", key, with_);
  }

  /** @param {string} type @param {string} key @param {{ shift?: boolean, ctrl?: boolean }} [with_] */
  key(type, key, { shift = false, ctrl = false } = {}) {
    const code =
      /** @type {Record<string, string>} */ (CODES)[key] ?? (/^[a-z]$/i.test(key) ? `Key${key.toUpperCase()}` : key);
    const event = { key, code, shiftKey: shift, ctrlKey: ctrl, bubbles: true, cancelable: true, composed: true };
    const target = /** @type {any} */ (this.document.activeElement ?? this.document.body);
    const goes = target.dispatchEvent(new this.window.KeyboardEvent(type, event));
    if (type !== "keydown" || key !== "Enter" || !goes) return;
    if (target.matches("button, summary, a")) target.click();
    else target.form?.requestSubmit(); // as a browser does
  }

  /** Types over what stands there, and goes on to the next field. @param {string | HTMLElement} part @param {string} words */
  async fill(part, words) {
    const one = () => (typeof part === "string" ? this.find(part) : part);
    await until(`${part} can be filled`, () => isShown(one()) && !one().disabled);
    const target = one();
    target.focus();
    target.value = words;
    for (const type of ["input", "change"]) target.dispatchEvent(new this.window.Event(type, { bubbles: true }));
  }

  /** Chooses files, as after the system's own dialog. @param {string} selector @param {...[string, string | Uint8Array]} files names and contents */
  choosesFiles(selector, ...files) {
    const input = this.find(selector);
    const chosen = files.map(([name, content]) => new this.window.File([content], name));
    Object.defineProperty(input, "files", { value: chosen, configurable: true });
    input.dispatchEvent(new this.window.Event("change", { bubbles: true }));
  }

  /** An option by what it says. @param {string | HTMLElement} part @param {string} words */
  async choose(part, words) {
    const target = typeof part === "string" ? this.find(part) : part;
    const option = [...target.options].find((each) => each.text === words);
    assert.ok(option, `${words} is none of ${[...target.options].map((each) => each.text).join(", ")}`);
    await this.fill(target, option.value);
  }
}
