// Lessons as a teacher gives them: from the list to the comparison, with a class that votes; and running until.

import assert from "node:assert/strict";
import { test } from "node:test";
import { isShown } from "./missing.js";
import { fresh, open } from "./page.js";
import { command, door, long, state, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

const DEMOS = ["dark", "loop", "twins", "small", "kidnapped", "quicker"];
const quickly = () => command("set_speed", { factor: 0 });

const MOST_WORDS = 90;

/** Waits for a state of the lesson. In none may the card have more to read than this. @param {Page} page @param {string} name */
async function isIn(page, name) {
  await until(`the lesson is in ${name}`, () => page.find("#lesson").dataset.state === name);
  assert.ok(inSight(page).length <= MOST_WORDS, `${name}: ${inSight(page).join(" ")}`);
}

/** The words of the card that are unfolded. @param {Page} page */
function inSight(page) {
  const walk = page.document.createTreeWalker(page.find("#lesson"), 4); // texts
  const texts = [];
  while (walk.nextNode())
    if (isShown(/** @type {Element} */ (walk.currentNode.parentElement))) texts.push(walk.currentNode.textContent);
  return texts.join(" ").match(/\S*[\p{L}\p{N}]\S*/gu) ?? [];
}

/** @param {Page} page @param {string} name */
async function choose(page, name) {
  await page.click("#lessons");
  const card = await until("it is listed", () => page.text(`#lessons-list [data-name=${name}]`));
  await page.click(`#lessons-list [data-name=${name}]`);
  await until("the list is closed", () => !page.find("#lessons-dialog").open);
  await until("it is this lesson", () => card.includes(page.text("#lesson-title") || "none yet"));
  await isIn(page, "predict");
}

/** @param {Page} page @param {number} k */
const option = (page, k) => page.click(page.all(".option")[k]);

test("a lesson from the list to the sandbox, with a class that votes", () =>
  fresh(async (page) => {
    await choose(page, "packet");
    assert.equal(page.document.activeElement?.id, "lesson-title");
    await page.says("#lesson-text", "Pose cells");
    assert.ok(!page.shown("#lesson-text") && !page.shown("#lesson-formulas math"));
    await page.click("#lesson-what summary");
    assert.ok(page.shown("#lesson-formulas math"));
    await page.click("#lesson-what summary");
    await until("the card shows the address", () => page.find(".vote-link a")?.href === door);
    await open(
      async (pupil) => {
        const counts = () => page.all(".option .count").map((count) => count.textContent);
        await until("there are options", () => pupil.all(".option").length > 1);
        await option(pupil, 1);
        await pupil.says("#vote-said", "Your vote counts");
        await until("the vote is counted", () => counts()[1] === "1");
        await page.says(".class-votes", /^1 vote$/);
        await option(pupil, 0);
        await until("a voter counts once", () => counts()[0] === "1" && counts()[1] === "");
        await option(page, 1);
        await page.says("#lesson-show", "Let it happen");
        await page.click("#lesson-show");
        await isIn(page, "showing");
        await page.says("#lesson-watch", "What to watch");
        assert.equal(page.text(".views [aria-pressed=true]"), "Pose cells");
        await quickly();
        await isIn(page, "compared");
        await pupil.says("#vote-said", "It came true");
      },
      { base: door }, // that of the network
    );
    assert.equal(page.find(".outcome").dataset.tone, "wrong");
    await page.says(".outcome", "8 cells on, and 9 layers lower");
    assert.equal(page.all(".option")[0].dataset.look, "true");
    assert.ok(!page.shown(".option"));
    await page.push("Moments", "#lesson");
    await page.click(page.all(".moments button").at(-1));
    const end = (await state()).time_s;
    await page.push("Try it", "#lesson");
    await page.click(".try button");
    await page.says("#events", "packet put in");
    await isIn(page, "sandbox");
    assert.ok(page.shown(".try") && !page.shown(".happened"));
    assert.ok((await state()).time_s >= end);
    await page.click("#lessons");
    await until("it counts as gone through", () => page.shown("#lessons-list [data-name=packet] .gone-through"));
    await page.click("#lessons-close");
    await page.click("#lesson-next");
    await page.says("#lesson-title", "Packets merge and compete");
    await page.click("#lesson-leave");
    await until("the card is away", () => !page.shown("#lesson"));
  }));

test("from a lesson the run before is a click away", () =>
  fresh(async (page) => {
    await command("step", { ticks: 123 });
    page.press("2"); // the office, by its key
    await choose(page, "packet");
    await until("the lesson turns to its own view", () => page.document.body.dataset.plate === "pose");
    await page.push("Your run", "#lesson");
    await until("the card is away", () => !page.shown("#lesson"));
    const now = await state();
    assert.deepEqual([now.tick, now.running, now.lesson], [123, false, null]);
    await until("the office is seen again", () => page.document.body.dataset.plate === "office");
  }));

test("a lesson whose text comes when it is being left does not keep its view", () =>
  fresh(async (page) => {
    const { window } = page;
    const { fetch } = window;
    let come = () => {};
    const late = new Promise((go) => (come = () => go(null)));
    window.fetch = async (/** @type {string} */ asked, /** @type {any} */ how) => {
      if (asked === "/api/lessons/packet") await late;
      return fetch(asked, how);
    };
    await command("step", { ticks: 5 });
    page.press("2"); // the office, by its key
    await command("begin_lesson", { name: "packet" });
    await until("the run waits", () => !page.find(".go-back").hidden);
    const socket = window.sockets.at(-1);
    const hears = socket.onmessage;
    /** @type {any[]} */
    const states = [];
    socket.onmessage = (/** @type {any} */ event) => {
      const isState = typeof event.data === "string" && JSON.parse(event.data).type === "state";
      isState ? states.push(event) : hears(event);
    };
    page.find(".go-back").click(); // in a card that is not drawn yet; others have the button elsewhere
    page.find(".go-back").click(); // a second answer would be that there is nothing to go back to
    await page.says("#toasts", "goes on from where it was");
    come();
    await page.says("#lesson-title", /./);
    await until("a state tells of it", () => states.length > 0);
    socket.onmessage = hears;
    for (const event of states) hears(event);
    await until("the run does not wait", () => page.find(".go-back").hidden);
    assert.equal(page.document.body.dataset.plate, "office");
  }));

test("each of the six demos is three clicks from a fresh page", long, () =>
  fresh(
    async (page) => {
      for (const name of DEMOS) {
        await choose(page, name);
        await page.click("#lesson-show");
        await isIn(page, "showing");
        assert.ok((await state()).running, name);
        await page.click("#lesson-leave");
        await until("the card is away", () => !page.shown("#lesson"));
      }
    },
    { first: true },
  ),
);

test("it runs until something happens and stops there", () =>
  fresh(async (page) => {
    const ask = async (/** @type {string} */ words) => {
      if (!page.shown("#until-box")) await page.click("#until-open");
      await page.click("#until-box button", words);
    };
    await quickly();
    await ask("a loop closes");
    await page.told("Stopped at this very tick");
    const { running, until: wish } = await state();
    assert.ok(!running && (wish === null || wish.state === "met"));
    await page.click("#until-open");
    await page.choose("[aria-label='Which place']", "printer");
    await page.fill("[aria-label='How many packets']", "3");
    await ask("packets compete:");
    const wished = async (/** @type {string} */ what) =>
      until(what, async () => (await state()).until?.what === what && (await state()).until.words);
    assert.match(await wished("packets"), /3 packets compete/);
    await command("pause");
    await ask("it comes to");
    assert.match(await wished("place"), /comes to printer/);
    await command("pause");
    const said = page.toasted.size;
    await ask("it is at its goal"); // there is none: that is refused
    await until("it is refused", () => page.toasted.size > said);
  }));

test("a clicker goes through a lesson", () =>
  fresh(async (page) => {
    page.press("z");
    page.press("c");
    await page.click("#lessons-list [data-name=packet]");
    await isIn(page, "predict");
    await page.click(".option input");
    page.press("PageDown"); // although a radio button has the focus
    await isIn(page, "showing");
    await quickly();
    await isIn(page, "compared");
    assert.equal(page.find(".outcome").dataset.tone, "right");
    page.press("PageUp");
    await isIn(page, "predict");
    page.press("PageDown");
    await quickly();
    await isIn(page, "compared");
    page.press("PageDown");
    await page.says("#lesson-title", "Packets merge and compete");
    page.press("z");
  }));

test("rounds are shown one after the other", () =>
  fresh(async (page) => {
    await choose(page, "merge");
    await option(page, 0);
    await page.click("#lesson-show");
    await isIn(page, "showing");
    await quickly();
    await page.says("#lesson-show", "Show the next round");
    assert.ok(page.find(".option input").disabled);
    await page.click("#lesson-show");
    await isIn(page, "showing");
    await quickly();
    await isIn(page, "compared");
    await page.says("#lesson-which", "round 2 of 2");
  }));

test("an address begins a lesson once; one that is broken off says by what, and begins once more", () =>
  fresh(
    async (page) => {
      await isIn(page, "predict");
      assert.ok(!page.window.location.href.includes("#")); // loaded again, the page begins nothing
      assert.equal((await state()).lesson.name, "dark");
      assert.ok(!page.shown("#lesson-again"));
      await page.click("#lesson-show");
      await isIn(page, "showing");
      await command("drive", { speed: 0.2, yaw_rate: 0 });
      await isIn(page, "sandbox");
      await page.says("#lesson-doing", "Broken off: somebody drove the robot by hand.");
      assert.ok(page.find("#lesson-again").classList.contains("go"));
      await page.click("#lesson-again");
      await isIn(page, "predict");
      assert.ok(!page.text("#lesson-doing").includes("Broken off"));
      assert.ok(!page.find("#lesson-again").classList.contains("go"));
    },
    { path: "#lesson=dark" },
  ));

test("a symbol leads to its row in Tune, and the card to Inspect where that tells why", () =>
  fresh(async (page) => {
    const tab = () => page.text("#panel [role=tab][aria-selected=true]");
    await choose(page, "quicker");
    await page.click("#lesson-what summary");
    await page.click("#lesson-formulas .symbols button");
    assert.equal(tab(), "Tune");
    const rows = () => page.all("#panel .knob").filter((knob) => knob.checkVisibility());
    await until("it is the only row", () => rows().length === 1);
    assert.ok(rows()[0].contains(page.document.activeElement));
    assert.match(rows()[0].title, /moving average/);

    await choose(page, "snap");
    await page.click("#lesson-show");
    await isIn(page, "showing");
    await quickly();
    await isIn(page, "compared");
    await page.click("#panel [role=tab]");
    page.press("z"); // presenting, the panel is away
    await until("it presents", () => page.document.body.dataset.presenter === "true");
    await page.click(".outcome button");
    assert.equal(tab(), "Inspect");
    await page.says("#panel", "What led to it");
    page.press("z");
  }));
