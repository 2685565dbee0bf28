/* The stress below the surface: filled contours, or fringes as photoelasticity shows them. */

import { INK, multiple } from "./axes.js";

const BANDS = 12, FRINGES = 10;
// Colours from no stress to the largest.
const COLOURS = ["fcfdbf", "feca8d", "fd9668", "f1605d", "cd4071", "9e2f7f", "721f81", "440f76", "180f3d", "000004"]
  .map(text => [0, 2, 4].map(k => parseInt(text.slice(k, k + 2), 16)));

function colour(share) {
  const place = Math.min(Math.max(share, 0), 1) * (COLOURS.length - 1), k = Math.min(Math.floor(place), COLOURS.length - 2);
  return COLOURS[k].map((one, channel) => one + (place - k) * (COLOURS[k + 1][channel] - one));
}

const TABLE = Array.from({ length: BANDS }, (_, band) => colour((band + 0.5) / BANDS));

/** Colours as the four bytes of a pixel. */
function packed(colours) {
  const bytes = new Uint8ClampedArray(4 * colours.length);
  colours.forEach((one, k) => bytes.set([...one, 255], 4 * k));
  return new Uint32Array(bytes.buffer);
}

const LINE = 0.72; // brightness of the lines between bands
const BAND = packed(TABLE), EDGE = packed(TABLE.map(one => one.map(channel => LINE * channel)));
const GREYS = 256, FRINGE = packed(Array.from({ length: GREYS }, (_, k) => Array(3).fill(255 * Math.sin(Math.PI * k / GREYS) ** 2)));

/** A round number that is not below a stress; the last one while the stress is between two fifths of it and all. */
export function scaled(last, top) {
  if (last && top <= last && top > 0.4 * last) return last;
  const power = 10 ** Math.floor(Math.log10(top || 1));
  return [1.2, 1.6, 2, 2.5, 3, 4, 5, 6, 8, 10, 12].map(times => times * power).find(round => round >= top) ?? top;
}

/** The image of stresses (rows, columns) at the middles of cells, on a canvas of its own. */
export function image(values, [rows, columns], width, height, kind, top) {
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = [width, height];
  const pen = canvas.getContext("2d"), data = pen.createImageData(width, height), pixels = new Uint32Array(data.data.buffer);
  const left = new Int32Array(width), share = new Float64Array(width), next = columns > 1 ? 1 : 0;
  for (let i = 0; i < width; i++) {
    const place = Math.min(Math.max((i + 0.5) * columns / width - 0.5, 0), columns - 1);
    left[i] = Math.min(Math.floor(place), Math.max(columns - 2, 0));
    share[i] = columns > 1 ? place - left[i] : 0;
  }
  const is_fringes = kind === "fringes", above = new Int32Array(width).fill(-1), row_values = new Float64Array(columns);
  for (let j = 0, at = 0; j < height; j++) {
    const place = Math.min(Math.max((j + 0.5) * rows / height - 0.5, 0), rows - 1);
    const row = Math.min(Math.floor(place), Math.max(rows - 2, 0)), down = rows > 1 ? place - row : 0;
    const upper = columns * row, lower = rows > 1 ? upper + columns : upper;
    for (let k = 0; k < columns; k++) {
      const value = ((1 - down) * values[upper + k] + down * values[lower + k]) / top;
      row_values[k] = value >= 0 ? value : 1; // no number stands for an infinite stress
    }
    for (let i = 0, before = -1; i < width; i++, at++) {
      const k = left[i], part = row_values[k] + share[i] * (row_values[k + next] - row_values[k]);
      if (is_fringes) {
        pixels[at] = FRINGE[Math.floor(GREYS * FRINGES * part) % GREYS];
      } else {
        const band = Math.min(Math.floor(BANDS * part), BANDS - 1);
        pixels[at] = (before >= 0 && band !== before) || (above[i] >= 0 && band !== above[i]) ? EDGE[band] : BAND[band];
        before = above[i] = band;
      }
    }
  }
  pen.putImageData(data, 0, 0);
  return canvas;
}

/** What the colours mean, in a line above the picture. */
export function key(pen, box, y, kind, top, infinite) {
  const [factor, unit] = multiple(top, "Pa"), text = value => `${+(value * factor).toPrecision(3)} ${unit}`;
  pen.fillStyle = INK;
  pen.textBaseline = "middle";
  pen.textAlign = "right";
  const last = infinite ? `\u2265 ${text(top)}` : text(top);
  if (kind === "fringes") {
    pen.fillText(`largest shear stress: ${text(top / FRINGES)} a fringe`, box.right, y);
    return;
  }
  pen.fillText(last, box.right, y);
  const end = box.right - pen.measureText(last).width - 6, size = Math.min(144, 0.3 * (box.right - box.left)), start = end - size;
  for (let band = 0; band < BANDS; band++) {
    pen.fillStyle = `rgb(${TABLE[band].map(Math.round).join()})`;
    pen.fillRect(start + size * band / BANDS, y - 5, size / BANDS + 0.5, 10);
  }
  pen.fillStyle = INK;
  pen.fillText("0", start - 6, y);
  pen.textAlign = "left";
  pen.fillText(kind === "mises" ? "von Mises stress" : "largest shear stress", box.left, y);
}
