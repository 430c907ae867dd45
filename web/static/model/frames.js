// A message with arrays as the server frames it (web/panel/panel.py): the head's length, the head, the arrays.

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
