/* The stress below the surface: filled contours, or fringes as photoelasticity shows them. */

import { INK, prefix } from "./axes.js";

const BANDS = 12, FRINGES = 10;
// Colours from no stress to the largest.
const COLOURS = ["fcfdbf", "feca8d", "fd9668", "f1605d", "cd4071", "9e2f7f", "721f81", "440f76", "180f3d", "000004"]
  .map(text => [0, 2, 4].map(k => parseInt(text.slice(k, k + 2), 16)));

function colour(share) {
  const place = Math.min(Math.max(share, 0), 1) * (COLOURS.length - 1), k = Math.min(Math.floor(place), COLOURS.length - 2);
  return COLOURS[k].map((one, channel) => one + (place - k) * (COLOURS[k + 1][channel] - one));
}

const TABLE = Array.from({ length: BANDS }, (_, band) => colour((band + 0.5) / BANDS));

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
  const pen = canvas.getContext("2d"), data = pen.createImageData(width, height), pixels = data.data;
  const left = new Int32Array(width), share = new Float64Array(width);
  for (let i = 0; i < width; i++) {
    const place = Math.min(Math.max((i + 0.5) * columns / width - 0.5, 0), columns - 1);
    left[i] = Math.min(Math.floor(place), Math.max(columns - 2, 0));
    share[i] = columns > 1 ? place - left[i] : 0;
  }
  const above = new Int32Array(width).fill(-1), next = columns > 1 ? 1 : 0;
  for (let j = 0; j < height; j++) {
    const place = Math.min(Math.max((j + 0.5) * rows / height - 0.5, 0), rows - 1);
    const row = Math.min(Math.floor(place), Math.max(rows - 2, 0)), down = rows > 1 ? place - row : 0;
    const upper = columns * row, lower = rows > 1 ? upper + columns : upper;
    let before = -1;
    for (let i = 0; i < width; i++) {
      const a = left[i], s = share[i];
      const value = (1 - down) * ((1 - s) * values[upper + a] + s * values[upper + a + next]) + down * ((1 - s) * values[lower + a] + s * values[lower + a + next]);
      const part = Number.isNaN(value) ? 1 : value / top, at = 4 * (width * j + i);
      if (kind === "fringes") {
        const bright = 255 * Math.sin(Math.PI * FRINGES * part) ** 2;
        pixels[at] = pixels[at + 1] = pixels[at + 2] = bright;
      } else {
        const band = Math.min(Math.floor(BANDS * part), BANDS - 1), is_line = (before >= 0 && band !== before) || (above[i] >= 0 && band !== above[i]);
        const [red, green, blue] = TABLE[Math.max(band, 0)], dim = is_line ? 0.72 : 1;
        [pixels[at], pixels[at + 1], pixels[at + 2]] = [dim * red, dim * green, dim * blue];
        before = above[i] = band;
      }
      pixels[at + 3] = 255;
    }
  }
  pen.putImageData(data, 0, 0);
  return canvas;
}

/** What the colours mean, in a line above the picture. */
export function key(pen, box, y, kind, top, infinite) {
  const [factor, letter] = prefix(top), text = value => `${+(value * factor).toPrecision(3)} ${letter}Pa`;
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
