// Which keys mean what, and where; and those of a page that only looks on.

import assert from "node:assert/strict";
import { test } from "node:test";
import { actOf, GROUPS, meaningOf, written } from "../../../web/static/ui/keys.js";
import { isLook, WATCHER_KEYS, looksOn, newId } from "../../../web/static/net/connection.js";

const NOWHERE = { typing: false, arrows: false, pressing: false, dialog: false };
const FREE = { ctrlKey: false, metaKey: false, altKey: false, isComposing: false };
/** @param {string} code @param {string} key @param {Partial<import("../../../web/static/ui/keys.js").Pressed>} [rest] */
const pressed = (code, key, rest = {}) => ({ code, key, ...FREE, ...rest });
const ROWS = GROUPS.flatMap(
  ({ rows }) => /** @type {readonly import("../../../web/static/ui/keys.js").Row[]} */ (rows),
);
const HELP = ROWS.flatMap(({ keys }) => keys);

// What layouts write in the places of a US keyboard, row by row: alone, and with shift; and with AltGr by place.
const CODES = [
  ...[..."1234567890"].map((digit) => `Digit${digit}`),
  ...[..."QWERTYUIOP"].map((letter) => `Key${letter}`),
  ...["BracketLeft", "BracketRight"],
  ...[..."ASDFGHJKL"].map((letter) => `Key${letter}`),
  "Semicolon",
  ...[..."ZXCVBNM"].map((letter) => `Key${letter}`),
  ...["Comma", "Period", "Slash", "Backslash", "Minus"],
];
/** @type {Record<string, { alone: string, shift: string, third?: Record<string, string> }>} */
const LAYOUTS = {
  QWERTY: {
    alone: "1234567890qwertyuiop[]asdfghjkl;zxcvbnm,./\\-",
    shift: "!@#$%^&*()QWERTYUIOP{}ASDFGHJKL:ZXCVBNM<>?|_",
  },
  QWERTZ: {
    alone: "1234567890qwertzuiopü+asdfghjklöyxcvbnm,.-#ß",
    shift: `!"§$%&/()=QWERTZUIOPÜ*ASDFGHJKLÖYXCVBNM;:_'?`,
    third: { Digit8: "[", Digit9: "]" },
  },
  AZERTY: {
    alone: `&é"'(-è_çàazertyuiop^$qsdfghjklmwxcvbn,;:!*)`,
    shift: "1234567890AZERTYUIOP¨£QSDFGHJKLMWXCVBN?./§µ°",
    third: { Digit5: "[", Minus: "]" },
  },
  Dvorak: {
    alone: `1234567890',.pyfgcrl/=aoeuidhtns;qjkxbmwvz\\[`,
    shift: `!@#$%^&*()"<>PYFGCRL?+AOEUIDHTNS:QJKXBMWVZ|{`,
    third: { Equal: "]" },
  },
  "Turkish F": {
    alone: "1234567890fgğıodrnhpqwuieaütkmlyjövcçzsb.,x/",
    shift: `!"^$%&'()=FGĞIODRNHPQWUİEAÜTKMLYJÖVCÇZSB:;X?`,
    third: { Digit8: "[", Digit9: "]" },
  },
  Russian: {
    alone: "1234567890йцукенгшщзхъфывапролджячсмитьбю.\\-",
    shift: `!"№;%:?*()ЙЦУКЕНГШЩЗХЪФЫВАПРОЛДЖЯЧСМИТЬБЮ,/_`,
  },
  Greek: {
    alone: "1234567890;ςερτυθιοπ[]ασδφγηξκλ΄ζχψωβνμ,./\\-",
    shift: "!@#$%^&*():΅ΕΡΤΥΘΙΟΠ{}ΑΣΔΦΓΗΞΚΛ¨ΖΧΨΩΒΝΜ<>?|_",
  },
  Arabic: {
    alone: "1234567890ضصثقفغعهخحجدشسيبلاتنمكئءؤرﻻىةوزظ\\-",
    shift: "!@#$%^&*()ًٌَُإ×؛<>:ٍِ]ْلأـ،/ِْآلآ’,.؟|_",
  },
};

/** All that can be pressed on a layout. @param {string} name */
function* strokes(name) {
  const { alone, shift, third = {} } = LAYOUTS[name];
  for (const [k, code] of CODES.entries()) {
    yield pressed(code, [...alone][k] ?? "Dead");
    yield pressed(code, [...shift][k] ?? "Dead", { shiftKey: true });
  }
  for (const [code, key] of Object.entries(third)) {
    yield pressed(code, key, { ctrlKey: true, altKey: true }); // Windows
    yield pressed(code, key, { getModifierState: (/** @type {string} */ state) => state === "AltGraph" });
    yield pressed(code, key, { altKey: true }); // a Mac
  }
  for (const key of ["Escape", "PageUp", "PageDown", "ArrowUp", "ArrowDown", "ArrowLeft", "ArrowRight"])
    yield pressed(key, key);
  yield pressed("Space", " ");
}

/** What a stroke does, in one word. @param {ReturnType<typeof pressed>} stroke */
function deed(stroke) {
  const meaning = meaningOf(stroke, NOWHERE);
  return !meaning
    ? "nothing"
    : "act" in meaning
      ? meaning.act
      : `${stroke.code.startsWith("Arrow") ? "Arr" : "Key"} ${meaning.drive}`;
}

const DRIVING_CODES = ["KeyW", "KeyA", "KeyS", "KeyD"];
const DRIVING = ["Key", "Arr"].flatMap((by) => ["up", "down", "left", "right"].map((way) => `${by} ${way}`));

test("no key has two meanings, none of them drives, and each is written as on keyboards", () => {
  assert.equal(new Set(HELP).size, HELP.length);
  assert.ok(!["w", "a", "s", "d"].some((key) => HELP.includes(key)));
  for (const { keys, act } of ROWS) for (const key of keys) assert.equal(actOf(key), act);
  assert.equal(actOf("y"), undefined);
  assert.deepEqual([" ", "Escape", "?"].map(written), ["space", "esc", "?"]);
});

for (const layout of Object.keys(LAYOUTS))
  test(`${layout}: every key of the help is there, and means what is written on it`, () => {
    assert.equal(CODES.length, [...LAYOUTS[layout].alone].length, layout);
    const all = [...strokes(layout)];
    const deeds = new Set(all.map(deed));
    const unmet = [...HELP, ...DRIVING].filter((key) => !deeds.has(key));
    assert.deepEqual(unmet, []);
    for (const stroke of all) {
      const written = stroke.key.length > 1 ? stroke.key : stroke.key.toLowerCase();
      const drives = DRIVING_CODES.includes(stroke.code) && !stroke.shiftKey;
      if (drives) {
        assert.match(deed(stroke), /^Key /); // and means nothing else
        const shifted = all.find(({ code, shiftKey }) => code === stroke.code && shiftKey);
        if (actOf(written)) assert.equal(shifted && deed(shifted), written); // as the help says
      } else if (actOf(written)) assert.equal(deed(stroke), written);
    }
  });

test("four keys drive by their places, and mean what a layout writes there with shift", () => {
  const shifted = (/** @type {string} */ code, /** @type {string} */ key) => pressed(code, key, { shiftKey: true });
  for (const key of ["w", "z", ",", "ц", "ς"])
    assert.deepEqual(meaningOf(pressed("KeyW", key), NOWHERE), { drive: "up" });
  assert.deepEqual(meaningOf(shifted("KeyW", "Z"), NOWHERE), { act: "z" }); // French
  assert.deepEqual(meaningOf(shifted("KeyA", "Q"), NOWHERE), { act: "q" });
  assert.deepEqual(meaningOf(shifted("KeyW", "<"), NOWHERE), { act: "," }); // Dvorak
  assert.deepEqual(meaningOf(pressed("KeyZ", "w"), NOWHERE), { act: "w" }); // which nothing has
  assert.deepEqual(meaningOf(pressed("Escape", "Escape"), NOWHERE), { act: "Escape" });
  assert.deepEqual(meaningOf(pressed("KeyE", "E"), NOWHERE), { act: "e" });
});

test("nothing is taken from who types, from a control that has the focus, or from the browser's own keys", () => {
  const at = (/** @type {string} */ code, /** @type {string} */ key, /** @type {Partial<typeof NOWHERE>} */ where) =>
    meaningOf(pressed(code, key), { ...NOWHERE, ...where });
  for (const code of ["KeyW", "KeyK", "Space"]) {
    assert.equal(at(code, "k", { typing: true }), null);
    for (const flag of Object.keys(FREE)) assert.equal(meaningOf(pressed(code, "k", { [flag]: true }), NOWHERE), null);
  }
  assert.equal(at("ArrowLeft", "ArrowLeft", { arrows: true }), null); // a slider's
  assert.deepEqual(at("KeyA", "a", { arrows: true }), { drive: "left" });
  assert.equal(at("Space", " ", { pressing: true }), null); // a button's
  assert.deepEqual(at("KeyK", "K", { pressing: true }), { act: "k" });
  for (const code of ["KeyW", "ArrowUp", "Escape", "KeyK"])
    assert.equal(at(code, code.replace("Key", "").toLowerCase(), { dialog: true }), null);
  assert.deepEqual(at("Slash", "?", { dialog: true }), { act: "?" });
});

test("a page that only looks on says so, says what concerns itself alone, and has no key that steers", () => {
  assert.match(newId(true), /^watch-[0-9a-f]{32}$/);
  assert.match(newId(false), /^[0-9a-f]{32}$/); // as hard to guess
  assert.ok(looksOn(newId(true)) && !looksOn(newId(false)));
  assert.ok(["view", "theme", "tabs", "got"].every(isLook));
  assert.ok(!["kidnap", "switch", "replay", "present", "vote"].some(isLook));
  const acts = ROWS.map(({ act }) => act);
  for (const act of WATCHER_KEYS) assert.ok(acts.includes(act), act);
  for (const key of ["k", "e", " ", ".", "b", "x", "m", "o", "c", "PageDown"])
    assert.ok(!WATCHER_KEYS.has(actOf(key) ?? "escape"), key);
});
