// The side panel: what its tabs tell, its controls and its keys.

import assert from "node:assert/strict";
import { test } from "node:test";
import { fresh, open } from "./page.js";
import { command, post, state, until } from "./program.js";

/** @typedef {import("./page.js").Page} Page */

/** Half a minute of exploring, paused. @param {(page: Page) => Promise<void>} use */
const walked = (use) =>
  fresh(async (page) => {
    await command("step", { ticks: 300 });
    await use(page);
  });

/** A switch of a tab by what it says. @param {Page} page @param {string} tab @param {string} words */
const switchOf = (page, tab, words) =>
  page
    .all(`#panel-${tab} label`)
    .find((label) => label.textContent.includes(words))
    ?.querySelector("input");

test("every tab shows something, is told of while it is open only, and arrows go from one to the next", () =>
  walked(async (page) => {
    /** @type {string[]} */
    let asked = [];
    page.holds(({ type, names }) => {
      if (type === "tabs") asked = names;
      return false;
    });
    for (const [name, words] of [
      ["Senses", "local view cells"],
      ["Memory", "links of the goal memory"],
      ["Inspect", "Shift-click the map"],
      ["Tick", "of its 100 ms"],
      ["Truth", "map error, after alignment"],
      ["Office", "preset"],
      ["Tune", "For a lecture"],
    ]) {
      await page.says(await page.tab(name), words);
      if (name !== "Senses") await until(`only ${name} is asked for`, () => String(asked) === name);
    }
    page.press("p");
    await until("nobody sees what is hidden", () => asked.length === 0);
    page.press("p");
    await page.says(await page.tab("Senses"), `of ${(await state()).views})`);
    const ends = "where the winning packet was (start) and where the views brought it (finish)";
    await page.says(await page.tab("Memory"), ends);

    page.find("#tab-senses").focus();
    for (const [key, name] of [
      ["ArrowRight", "memory"],
      ["End", "tune"],
      ["ArrowRight", "senses"],
      ["ArrowLeft", "tune"],
      ["Home", "senses"],
    ]) {
      page.press(key);
      assert.equal(page.document.activeElement?.id, `tab-${name}`);
      assert.ok(page.shown(`#panel-${name}`));
    }
    assert.equal(page.all("[role=tab]").filter((tab) => tab.tabIndex === 0).length, 1);
  }));

test("a parameter is found, turned and set back; what is wrong with one is said; what somebody types stays typed", () =>
  walked(async (page) => {
    const tune = await page.tab("Tune");
    const knobs = () => page.all("#panel .knob").filter((knob) => knob.checkVisibility());
    await until("they have come", () => knobs().length > 5);
    await page.fill(`${tune} [type=search]`, "match threshold");
    const [field, back] = [knobs()[0].querySelector("input"), knobs()[0].querySelector("button")];
    const was = field.value;
    const isBack = () => until("it is as before", () => field.value === was && !back.checkVisibility());
    const turn = (/** @type {number} */ value) =>
      command("set_parameter", { name: "local_view.match_threshold", value });
    const turns = () => page.text("#events").split("match_threshold").length - 1;
    await page.fill(field, "7.5");
    await page.says("#events", "match_threshold");
    await page.click(back);
    await isBack();
    await page.fill(field, "-3");
    await page.told("match_threshold"); // why not
    await isBack();

    field.focus();
    field.value = "1";
    field.dispatchEvent(new page.window.Event("input", { bubbles: true }));
    await until("what was set back is told", () => turns() === 2);
    await turn(5);
    await until("it is told", () => turns() === 3);
    await command("step");
    await page.says("#clock", "0:30");
    assert.equal(field.value, "1");
    await page.fill(field, "5.5");
    await until("it is taken", () => turns() === 4);
    await turn(4);
    await until("it follows again", () => field.value === "4");
    await page.click(back);
    await isBack();

    await page.fill(`${tune} [type=search]`, "no such thing");
    await page.says(`${tune} [role=status]`, "nothing is called “no such thing”");
    await page.fill(`${tune} [type=search]`, "takes effect at reset");
    assert.ok(knobs().length > 3);
    assert.ok(knobs().every((one) => one.querySelector("[role=img]")));
  }));

test("Tune opens with the dozen of a lecture; sections are closed, and say how many they have and have changed", () =>
  walked(async (page) => {
    const tune = await page.tab("Tune");
    const dozen = () => page.all(`${tune} .dozen .knob`);
    await until("they have come", () => dozen().length === 12);
    assert.ok(dozen().every((knob) => knob.querySelector("i")?.textContent && knob.querySelector("p")?.textContent));
    assert.ok(page.all(`${tune} details`).every((section) => !section.open));
    const [first] = dozen().filter((knob) => knob.textContent.includes("inhibit"));
    await page.fill(first.querySelector("input"), "0.001");
    await page.says(`${tune} details`, "1 changed7");
    await page.fill(`${tune} [type=search]`, "φ inhibit");
    await page.says(`${tune} details`, "1 of 7");
    assert.ok(!first.checkVisibility(), "it is found in its section");
    await page.fill(`${tune} [type=search]`, "");
    await page.click(first.querySelector("button"));
    await until("it is as before", () => !page.text(`${tune} details`).includes("changed"));
  }));

test("a switch is on for all who look, and keys drive although it has been clicked", () =>
  walked(async (page) => {
    await page.tab("Memory");
    await open(async (other) => {
      await other.tab("Memory");
      const [here, there] = [page, other].map((one) => () => switchOf(one, "memory", "Occupancy among the pose cells"));
      await until("both have it", () => here() && there());
      assert.ok(!there().checked);
      here().click();
      await until("it is on there too", () => there().checked);
      there().click();
      await until("it is off here too", () => !here().checked);
      await page.click(here());
      await command("resume");
      page.down("ArrowLeft");
      await until("it is driven", async () => (await state()).mode === "manual");
      page.up("ArrowLeft");
      await command("pause");
      await page.click(here());
    });
  }));

test("a tick goes stage by stage from the panel, and over the page", () =>
  walked(async (page) => {
    const panel = await page.tab("Tick");
    await page.push("next stage", panel);
    await page.says(panel, "Stage 1 of 9");
    await page.push("next stage", panel);
    await page.says(`${panel} [aria-current]`, "View match");
    await page.push("back", panel);
    await page.says(`${panel} [aria-current]`, "Image and odometry");
    await page.push("tick", panel);
    await page.says(panel, "Next stage pauses");

    const { tick } = await state();
    page.press(",");
    const titles = [];
    for (let k = 1; k <= 9; k++) {
      await page.says("#walk .which", `${k} of 9`);
      titles.push(page.text("#walk .title"));
      if (k < 9) await page.click("#walk-next");
    }
    assert.deepEqual(titles, [
      ...["Image and odometry", "View match", "Injection by the view", "Path integration", "Excitation", "Inhibition"],
      ...["Normalisation", "Experience choice", "Map correction"],
    ]);
    assert.equal((await state()).tick, tick + 1);
    await page.click("#walk-back");
    await page.says("#walk .title", "Experience choice");
    await page.says(panel, "Stage 8 of 9");
    await page.says(panel, /A tick takes [\d.]+ of its 100 ms/);
    page.press(".");
    await until("it is over", () => !page.shown("#walk"));
  }));

test("a stored view is shown beside what is seen now; why a false positive came is told, and left out", () =>
  walked(async (page) => {
    const inspecting = () =>
      until("Inspect is open", () => page.text("#panel [role=tab][aria-selected=true]") === "Inspect");
    await page.push("Inspect the stored view");
    await inspecting();
    await page.says("#panel-inspect", "as it is stored");
    await page.tab("Senses");
    page.find("#panel-senses [role=slider]").focus();
    page.press("ArrowRight");
    page.press("Enter");
    await inspecting();

    const wrong = (/** @type {number} */ value) =>
      command("set_parameter", { name: "local_view.false_positives", value });
    await wrong(0.2);
    await command("step", { ticks: 100 });
    await wrong(0);
    const inspect = await page.tab("Inspect");
    await page.push("false positive", inspect);
    await page.says(inspect, "What led to it");
    await page.says(inspect, /\d+:\d\d view \d+ is reported instead: .false_positives. is 20%/);
    assert.equal(page.all("#panel .seen canvas").length, 2);
    await page.click("#panel .seen button");
    await page.says(inspect, "local view cell");
    await page.push("false positive", inspect);
    const { tick } = await state();
    await page.push("Go on without this view");
    await until("it is before that", async () => (await state()).tick < tick);
    await page.says(inspect, "Why did it happen?");
    await wrong(0); // it was not yet, there
  }));

test("people, lamps and presets are switched", () =>
  fresh(async (page) => {
    await command("reset", { world: "living" });
    const living = async () => (await state()).living;
    const turn = async (/** @type {string} */ name) =>
      page.click(await until(`there is a switch for ${name}`, () => switchOf(page, "office", name)));
    await page.tab("Office");
    await command("step");
    assert.equal((await living()).people, 3);
    for (const people of [0, 3]) {
      await turn("people");
      await until(`${people} people`, async () => {
        await command("step"); // the switch may come after a step, and is seen with the next
        return (await living()).people === people;
      });
    }
    await turn("hall west");
    await until("the lamp is off", async () => !(await living()).lamps["hall west"]);
    assert.ok((await living()).lamps["hall east"]);
    const values = async () => JSON.parse((await post("situation", {})).file).values;
    const before = await values();
    await page.choose("#panel-office [aria-label=preset]", "Pioneer 2DXE 2004");
    await page.says("#events", "preset Pioneer 2DXE 2004");
    await command("set_parameter", { name: "local_view.field_of_view", value: 1.2 }); // not that of the camera
    await page.told("robot.camera_fov_rad");
    await command("reset"); // a situation tells the values of its beginning
    const now = await values();
    for (const name of Object.keys(now).filter((name) => now[name] !== before[name]))
      await command("set_parameter", { name, value: before[name] });
  }));
