// What everybody does first: play, speed, restart, goals, places, help, presenting; and what the page says by itself.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh, open } from "./page.js";
import { command, state, told, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** @param {string} what @param {(now: any) => unknown} fits */
const becomes = (what, fits) => until(what, async () => fits(await state()));

test("play, speed and restart", () =>
  fresh(async (page) => {
    for (const words of ["× 4", "max", "× 1"]) {
      await page.choose("#speed", words);
      await becomes(words, (now) => now.speed === Number(page.find("#speed").value));
    }
    page.press(" ");
    await becomes("it plays", (now) => now.running);
    await until("the button says so", () => page.find("#play").getAttribute("aria-label") === "Pause");
    await page.click("#play");
    await becomes("it pauses", (now) => !now.running);
    page.press(".");
    await becomes("it has moved", (now) => now.tick > 0);
    await page.click("#restart summary");
    await page.click("#restart-same");
    await becomes("it begins again", (now) => now.tick === 0 && now.seed === 5);
    await page.click("#restart summary");
    await page.click("#restart-new");
    await becomes("it has another seed", (now) => now.seed !== 5);
    await page.choose("#world", (await told("worlds")).ours.loop);
    await becomes("it is in the other world", (now) => now.world === "loop");
  }));

test("two tabs agree, each in its own theme, which is kept", () =>
  fresh(async (one) => {
    if (one.document.documentElement.dataset.theme !== "dark") await one.click("#theme");
    const theme = (/** @type {Page} */ page) => page.document.documentElement.dataset.theme;
    await open(
      async (two) => {
        assert.equal(theme(two), "dark");
        await two.click("#theme");
        assert.deepEqual(
          [theme(one), theme(two), two.window.localStorage.getItem("theme")],
          ["dark", "light", "light"],
        );
        two.press(" ");
        await until("the other knows it", () => one.find("#play").getAttribute("aria-label") === "Pause");
        one.press(" ");
        await until("the other knows it", () => two.find("#play").getAttribute("aria-label") === "Play");
        await command("step");
        const seen = (/** @type {Page} */ page) =>
          ["#clock", "#seed", "#status", "#events"].map((part) => page.text(part));
        await until("they show the same", () => String(seen(one)) === String(seen(two)));
      },
      { kept: { theme: "dark" } },
    );
    await open(async (three) => assert.equal(theme(three), "light"), { kept: { theme: "light" } });
  }));

test("a refusal is a sentence; of toasts there is one, the newest, until a click or Escape takes it away", () =>
  fresh(async (page) => {
    const said = () => {
      const words = page.all(".toast span").map((part) => part.textContent);
      return words.filter((one) => !one.includes("graphics card"));
    };
    const detail = [{ field: "x", value: 9, reason: "there is no free floor" }];
    page.hear({ type: "answer", accepted: false, detail });
    await page.told("There is no free floor.");
    assert.ok(page.shown("#alerts .toast.bad"));
    page.press("Escape");
    for (const text of ["one", "two"]) page.hear({ type: "notice", text });
    assert.deepEqual(said(), ["Two."]);
    await page.click(page.find(".toast"));
    assert.deepEqual(said(), []);
    assert.deepEqual(
      ["alerts", "toasts"].map((id) => page.find(`#${id}`).getAttribute("role")),
      ["alert", "status"],
    );
  }));

test("every event has a name, a mark and a place in the legend; what goes wrong is told to everyone", () =>
  fresh(async (page) => {
    const { kinds } = await import("../../web/static/timeline/events.js");
    await command("step", { ticks: 300 });
    await page.says("#clock", "0:30");
    const event = (/** @type {number} */ time_s, /** @type {string} */ kind, text = `text of ${kind}`) => ({
      number: 10_000 + time_s,
      time_s,
      kind,
      text,
    });
    const events = [...kinds, "never heard of"].map((kind, k) => event(k, kind));
    page.hear({ type: "events", fresh: true, events });
    await until("all are marked", () => page.all("#timeline .mark").length === events.length);
    assert.equal(page.all("#legend li").length, kinds.length);
    assert.ok(page.all("#legend li").every((row) => row.textContent.trim()));
    assert.ok(page.text("#events").includes("never heard of: text of never heard of"));
    assert.equal(page.toasted.size, 1); // of those there were: the warning
    const late = { ...event(29, "unreachable", "no route to experience 12, on another submap"), number: 10_100 };
    page.hear({ type: "events", fresh: false, events: [late] });
    await page.told("No route to experience 12, on another submap");
    page.drag("#timeline", [[6 + (1188 * 29) / 60, 20]], () =>
      assert.match(page.text("#event-tip"), /no route: no route to experience 12/),
    );
    await command("back_to_now");
  }));

test("a newcomer is welcomed once, and sees a kidnap through", () =>
  fresh(
    async (page) => {
      await until("it is shown", () => page.shown("#first"));
      const rows = () => page.all("#first li").map((row) => row.dataset.state);
      assert.deepEqual(rows(), ["now", "later", "later"]);
      await page.click("#first-explore");
      await until("it knows enough", () => rows()[0] === "done" && !page.shown("#first-share"));
      const [x, y] = (await told("state?map=1")).map.xy[20];
      await command("set_goal", { x, y });
      await command("set_speed", { factor: 0 });
      await until("it has been sent", () => rows()[1] === "done");
      await page.click("#kidnap");
      await page.click("#first-find");
      await until("it is found again", () => rows()[2] === "done" && page.shown("#first-end"));
      await page.click("#first-close");
      assert.ok(!page.shown("#first"));
      assert.equal(page.window.localStorage.getItem("first minute"), "seen");
      page.press("?");
      await page.click("#help-first");
      await until("it is shown", () => page.shown("#first"));
      await until("this robot has explored", () => rows()[0] === "done");
      await command("reset", { seed: 8 });
      await until("another has not", () => rows()[0] === "now");
    },
    { first: true },
  ));

test("a place is chosen from a list by keyboard, and told aloud", () =>
  fresh(async (page) => {
    await command("step", { ticks: 250 });
    await command("tag", { name: "the printer" });
    page.press("/");
    const typed = "#places-typed";
    assert.equal(page.document.activeElement, page.find(typed));
    const rows = () => page.all("#places-list li");
    await page.says("#places-list li", "the printer");
    assert.ok(rows().length > 5);
    await page.fill(typed, "the print");
    await until("one is found", () => rows().length === 1);
    page.press("Enter");
    await until("it is chosen", () => !page.shown("#places-dialog") && page.shown("#goal"));
    await page.says("#said", "goal set");
    page.press("x");
    await becomes("there is none", (now) => now.goal === null);
    page.press("/");
    await page.fill(typed, "library");
    await page.says("#places-list li", "explores until it comes there");
    page.press("Enter"); // it is looked for, which a test need not wait for
    await until("it is chosen", () => !page.shown("#places-dialog"));
    await becomes("it explores until it comes there", (now) => now.until?.words.includes("library"));
    await command("pause");
    page.press("/");
    await page.fill(typed, "");
    await until("all are there", () => rows().length > 5);
    await page.push("Inspect", "#places-list");
    await page.says("#panel [role=tab][aria-selected=true]", "Inspect");
  }));

test("a place is named in the panel, and its name is a goal", () =>
  fresh(async (page) => {
    await command("step", { ticks: 300 });
    const panel = await page.tab("Office");
    await page.says(panel, "No place is named yet");
    const name = `${panel} [aria-label='name of this place']`;
    for (const words of ["the kitchen", "the desk"]) {
      await page.fill(name, words);
      await page.push("Robot is here", panel);
      await until(`${words} is there`, () => page.button(`go to ${words}`));
      await command("step", { ticks: 200 });
    }
    assert.equal(page.find(name).value, "");
    await page.push("go to the kitchen");
    const first = await until("it goes", async () => (await state()).goal?.experience);
    await page.push("go to the desk");
    const second = await until("it goes elsewhere", async () => {
      const { goal } = await state();
      return goal && goal.experience !== first && goal.experience;
    });
    await page.push("forget the name the kitchen");
    await until("it is forgotten", () => !page.button("go to the kitchen"));
    assert.equal((await state()).goal.experience, second); // on the way, all the same
    await command("tag", { name: "the kitchen" });
    await until("others see it, too", () => page.button("go to the kitchen"));
  }));

test("the help lists the keys by group, and a dialog takes them", () =>
  fresh(async (page) => {
    page.press("?");
    await until("it is open", () => page.shown("#help-plates"));
    assert.ok(page.text("#help-dialog").split("Keys")[0].trim().split(/\s+/).length <= 150);
    await page.click(page.find("#help-dialog summary"));
    assert.ok(page.shown("#keys"));
    const heads = page.all("#keys h4").map((head) => head.textContent);
    assert.deepEqual(heads, ["Robot", "Time", "Looking", "Presenter", "Page"]);
    const row = page.all("#keys li").find((one) => one.textContent.includes("kidnap"));
    assert.equal(row.querySelector("kbd").textContent, "k");
    page.press("k");
    assert.equal((await state()).tick, 0);
    assert.ok(!page.text("#events").includes("kidnap"));
    page.press("?");
    await until("it is closed", () => !page.shown("#help-plates"));
    page.press("k");
    await page.says("#events", "kidnap");
  }));

test("a presenter goes on and back, and others may go through something", () =>
  fresh(async (page) => {
    const presses = (/** @type {string[]} */ keys, /** @type {string} */ view) => {
      for (const key of keys) page.press(key);
      assert.equal(page.text(".views [aria-pressed=true]"), view);
    };
    presses(["z", "PageDown", "PageDown"], "Pose cells");
    presses(["PageUp"], "Office");
    page.document.addEventListener("presenter:next", (event) => event.preventDefault());
    presses(["PageDown", "q"], "Office");
    assert.equal(page.document.body.dataset.presenter, "true");
    presses(["z", "PageDown"], "Office");
  }));

test("keys that are held drive; letting go, looking away or leaving stops", () =>
  fresh(async (page) => {
    await command("resume");
    /** Drives left and on, until it does. @param {Page} driver */
    const drives = async (driver) => {
      const { robot } = await state();
      for (const key of ["w", "a"]) driver.down(key);
      await becomes("it is driven", ({ mode, robot: now }) => {
        const turned = Math.sin(now.heading_rad - robot.heading_rad);
        return mode === "manual" && turned > 0.05 && Math.hypot(now.x - robot.x, now.y - robot.y) > 0.02;
      });
    };
    const stands = () =>
      until("it stands", async () => {
        const { robot, tick } = await state();
        await becomes("a second later", (now) => now.tick >= tick + 10);
        return JSON.stringify(robot) === JSON.stringify((await state()).robot);
      });
    await drives(page);
    for (const key of ["w", "a"]) page.up(key);
    await stands();
    page.document.hasFocus = () => false;
    for (const end of ["blur", "pagehide"]) {
      await drives(page);
      page.window.dispatchEvent(new page.window.Event(end));
      await stands();
    }
    await open(drives);
    await stands();
  }));
