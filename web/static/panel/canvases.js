// Pictures in canvases: pixels as they are, enlarged without smoothing.

import { make } from "../ui/elements.js";
import { picture, rgb } from "../model/pixels.js";

/** A colour of the page's theme. @param {string} name of a custom property, without its dashes */
export const colourOf = (name) => rgb(getComputedStyle(document.documentElement).getPropertyValue(`--${name}`));

export class Picture {
  /** @param {string} words what it shows, for people who cannot see it: from the beginning, before there is anything to show */
  constructor(words) {
    this.canvas = make("canvas", { width: 1, height: 1, className: "pixels" });
    this.canvas.setAttribute("role", "img");
    this.says(words);
    this.turn = 0; // number of the latest request: a picture that is unpacked after a newer one is dropped
  }

  /** @param {string} words what it shows now */
  says(words) {
    if (this.canvas.getAttribute("aria-label") !== words) this.canvas.setAttribute("aria-label", words);
    return this;
  }

  /** @param {import("../model/pixels.js").Pixels} pixels */
  draw({ width, height, rgba }) {
    this.turn += 1;
    this.size(width, height);
    this.canvas.getContext("2d")?.putImageData(new ImageData(rgba, width, height), 0, 0);
  }

  /** @param {import("../net/connection.js").Parcel | undefined} parcel */
  async show(parcel) {
    if (!parcel) return;
    this.canvas.hidden = parcel.kind !== "jpeg" && parcel.values.length === 0; // the source has no such picture
    if (this.canvas.hidden) return;
    if (parcel.kind !== "jpeg") return this.draw(picture(parcel.values, parcel.shape));
    const turn = ++this.turn;
    const image = await createImageBitmap(new Blob([parcel.values], { type: "image/jpeg" }));
    if (turn === this.turn) {
      this.size(image.width, image.height);
      this.canvas.getContext("2d")?.drawImage(image, 0, 0);
    }
    image.close();
  }

  /** @param {number} width @param {number} height */
  size(width, height) {
    if (this.canvas.width !== width) this.canvas.width = width;
    if (this.canvas.height !== height) this.canvas.height = height;
  }
}
