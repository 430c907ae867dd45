// Which keys mean what, and where.

import assert from "node:assert/strict";
import { test } from "node:test";
import { meaningOf } from "../../../web/static/model/key_meanings.js";
import { GROUPS, actOf } from "../../../web/static/model/key_table.js";

const NOWHERE = { typing: false, arrows: false, pressing: false, dialog: false };
/** @param {string} code @param {string} key @param {Partial<import("../../../web/static/model/key_meanings.js").Pressed>} [rest] */
const pressed = (code, key, rest = {}) => ({
  code,
  key,
  ctrlKey: false,
  metaKey: false,
  altKey: false,
  isComposing: false,
  ...rest,
});

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

const HELP = GROUPS.flatMap(({ rows }) => rows.flatMap(({ keys }) => keys.map(String)));
const DRIVING_CODES = ["KeyW", "KeyA", "KeyS", "KeyD"];
const DRIVING = ["Key up", "Key down", "Key left", "Key right", "Arr up", "Arr down", "Arr left", "Arr right"];

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
  for (const key of ["w", "z", ",", "ц", "ς"])
    assert.deepEqual(meaningOf(pressed("KeyW", key), NOWHERE), { drive: "up" });
  assert.deepEqual(meaningOf(pressed("KeyW", "Z", { shiftKey: true }), NOWHERE), { act: "z" }); // French
  assert.deepEqual(meaningOf(pressed("KeyA", "Q", { shiftKey: true }), NOWHERE), { act: "q" });
  assert.deepEqual(meaningOf(pressed("KeyW", "<", { shiftKey: true }), NOWHERE), { act: "," }); // Dvorak
  assert.deepEqual(meaningOf(pressed("KeyZ", "w"), NOWHERE), { act: "w" }); // which nothing has
});

test("an arrow is the slider's, a letter drives also there", () => {
  assert.equal(meaningOf(pressed("ArrowLeft", "ArrowLeft"), { ...NOWHERE, arrows: true }), null);
  assert.deepEqual(meaningOf(pressed("KeyA", "a"), { ...NOWHERE, arrows: true }), { drive: "left" });
});

test("nothing is taken from who types, nor from the browser's own keys", () => {
  for (const code of ["KeyW", "KeyK", "Space"]) {
    assert.equal(meaningOf(pressed(code, "k"), { ...NOWHERE, typing: true }), null);
    for (const flag of ["ctrlKey", "metaKey", "altKey", "isComposing"])
      assert.equal(meaningOf(pressed(code, "k", { [flag]: true }), NOWHERE), null);
  }
});

test("space is the button's that has the focus, and play and pause elsewhere", () => {
  assert.equal(meaningOf(pressed("Space", " "), { ...NOWHERE, pressing: true }), null);
  assert.deepEqual(meaningOf(pressed("Space", " "), NOWHERE), { act: " " });
  assert.deepEqual(meaningOf(pressed("KeyK", "K"), { ...NOWHERE, pressing: true }), { act: "k" });
});

test("a dialog takes all keys but the one for help", () => {
  for (const [code, key] of [
    ["KeyW", "w"],
    ["ArrowUp", "ArrowUp"],
    ["Escape", "Escape"],
    ["KeyK", "k"],
  ])
    assert.equal(meaningOf(pressed(code, key), { ...NOWHERE, dialog: true }), null);
  assert.deepEqual(meaningOf(pressed("Slash", "?"), { ...NOWHERE, dialog: true }), { act: "?" });
});

test("Escape keeps its name, letters are small", () => {
  assert.deepEqual(meaningOf(pressed("Escape", "Escape"), NOWHERE), { act: "Escape" });
  assert.deepEqual(meaningOf(pressed("KeyE", "E"), NOWHERE), { act: "e" });
});
