/* Axes, lines and areas on a canvas. */

export const INK = "#2b2b2b", QUIET = "#666666", GRID = "#e9e9e9", FRAME = "#b0b0b0";
const USED = 0.5; // part of a range that is used, at least

/** Sizes of a picture [px]: what stands about it is smaller on a narrow screen. */
export function sizes(width) {
  const narrow = width < 560;
  return { left: narrow ? 50 : 66, right: 10, top: 26, bottom: 40, height: narrow ? 215 : 250, font: narrow ? 11 : 12, apart: [narrow ? 62 : 90, 38] };
}

/** A range that shows all: the last one if it does and half of it is used, so that what grows is seen to grow. */
export function fitted(last, low, high, room = [0.08, 0.08]) {
  const size = high - low || Math.abs(high) || 1;
  const wanted = { low: low - room[0] * size, high: high + room[1] * size };
  const shows = last && last.low <= low && high <= last.high && size >= USED * (last.high - last.low);
  return shows ? last : wanted;
}

/** For each unit, its multiples that people use, by their power of ten. */
const MULTIPLES = {
  "Pa": { 0: "Pa", 3: "kPa", 6: "MPa", 9: "GPa" },
  "N/m": { [-6]: "\u00b5N/m", [-3]: "mN/m", 0: "N/m", 3: "N/mm", 6: "kN/mm" },
  "N/m^2": { 0: "N/m\u00b2", 3: "kN/m\u00b2", 6: "N/mm\u00b2", 9: "kN/mm\u00b2" },
  "J/m^2": { [-6]: "\u00b5J/m\u00b2", [-3]: "mJ/m\u00b2", 0: "J/m\u00b2", 3: "kJ/m\u00b2" },
};
const PREFIXES = { [-12]: "p", [-9]: "n", [-6]: "\u00b5", [-3]: "m", 0: "", 3: "k", 6: "M" };

/** Factor and multiple of a unit that bring a number to between 1 and 1000. */
export function multiple(size, unit) {
  const known = MULTIPLES[unit] ?? Object.fromEntries(Object.entries(PREFIXES).map(([power, letter]) => [power, letter + unit]));
  if (!unit || !(Number.isFinite(size) && size > 0)) return [1, unit && known[0]];
  const powers = Object.keys(known).map(Number), power = 3 * Math.floor(Math.log10(size) / 3 + 1e-12);
  const kept = power < Math.min(...powers) - 3 ? 0 : Math.max(Math.min(...powers), Math.min(Math.max(...powers), power));
  return [10 ** -kept, known[kept]];
}

/** A number with four digits and its unit. */
export function quantity(value, unit) {
  const short = text => (text.includes("e") ? text : text.includes(".") ? text.replace(/\.?0+$/, "") : text).replace("-", "\u2212");
  if (!unit || value === 0) return `${short(value.toPrecision(4))} ${unit}`.trim();
  const [factor, name] = multiple(Math.abs(value), unit);
  return `${short((value * factor).toPrecision(4))} ${name}`;
}

/** Round values in a range, no more than so many, and what to write at them. */
function ticks(low, high, most) {
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const step = power * [1, 2, 5, 10].find(times => times * power * most >= high - low);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const first = Math.ceil(low / step - 1e-9), count = Math.floor(high / step + 1e-9) - first + 1;
  const values = Array.from({ length: Math.max(0, count) }, (_, k) => (first + k) * step);
  return values.map(value => [value, value.toFixed(digits).replace(/^-(?=.*[1-9])/, "\u2212").replace(/^-/, "")]);
}

/** Axes in a box; the places on the canvas of what is drawn within. `up.low` is at the bottom, also if it is the larger number. */
export function axes(pen, box, across, up, names, size) {
  const at = {
    box,
    x: value => box.left + (box.right - box.left) * (value - across.low) / (across.high - across.low),
    y: value => box.bottom - (box.bottom - box.top) * (value - up.low) / (up.high - up.low),
  };
  pen.lineWidth = 1;
  pen.strokeStyle = GRID;
  pen.fillStyle = INK;
  pen.beginPath();
  pen.textAlign = "center";
  pen.textBaseline = "top";
  for (const [value, text] of ticks(across.low, across.high, (box.right - box.left) / size.apart[0])) {
    const x = Math.round(at.x(value)) + 0.5;
    pen.moveTo(x, box.top);
    pen.lineTo(x, box.bottom);
    if (names[0]) pen.fillText(text, x, box.bottom + 5);
  }
  pen.fillText(names[0], 0.5 * (box.left + box.right), box.bottom + 21);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [value, text] of ticks(Math.min(up.low, up.high), Math.max(up.low, up.high), (box.bottom - box.top) / size.apart[1])) {
    const y = Math.round(at.y(value)) + 0.5;
    pen.moveTo(box.left, y);
    pen.lineTo(box.right, y);
    pen.fillText(text, box.left - 5, y);
  }
  pen.stroke();
  pen.save();
  pen.translate(size.font - 1, 0.5 * (box.top + box.bottom));
  pen.rotate(-0.5 * Math.PI);
  pen.textAlign = "center";
  pen.fillText(names[1], 0, 0);
  pen.restore();
  return at;
}

export function frame(pen, { box }) {
  pen.lineWidth = 1;
  pen.strokeStyle = FRAME;
  pen.strokeRect(box.left + 0.5, box.top + 0.5, box.right - box.left, box.bottom - box.top);
}

/** What is painted stays within the box. */
export function within(pen, { box }, paint) {
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
  pen.clip();
  paint();
  pen.restore();
}

/** A line, cut where it has no value. */
export function line(pen, at, x, y, colour, width, dash = []) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.setLineDash(dash);
  pen.beginPath();
  let is_down = false;
  for (let i = 0; i < x.length; i++) {
    if (Number.isNaN(y[i])) is_down = false;
    else if (is_down) pen.lineTo(at.x(x[i]), at.y(y[i]));
    else pen.moveTo(at.x(x[i]), at.y(y[i])), is_down = true;
  }
  pen.stroke();
  pen.setLineDash([]);
}

/** The area between a line and a height. */
export function area(pen, at, x, y, height, colour) {
  if (!x.length) return;
  pen.fillStyle = colour;
  pen.beginPath();
  pen.moveTo(at.x(x[0]), at.y(height));
  for (let i = 0; i < x.length; i++) pen.lineTo(at.x(x[i]), at.y(y[i]));
  pen.lineTo(at.x(x[x.length - 1]), at.y(height));
  pen.fill();
}

/** The names of lines with their colours, above a picture, from the right. */
export function legend(pen, right, y, entries) {
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [text, colour, dash] of [...entries].reverse()) {
    pen.fillStyle = INK;
    pen.fillText(text, right, y);
    right -= pen.measureText(text).width + 6;
    pen.strokeStyle = colour;
    pen.lineWidth = 3;
    pen.setLineDash(dash ?? []);
    pen.beginPath();
    pen.moveTo(right - 16, y);
    pen.lineTo(right, y);
    pen.stroke();
    pen.setLineDash([]);
    right -= 30;
  }
}

export function dot(pen, x, y, radius, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

/** An arrow from one point of the canvas to another. */
export function arrow(pen, [x, y], [to_x, to_y], colour, head = 7, dash = []) {
  const size = Math.hypot(to_x - x, to_y - y) || 1, u = (to_x - x) / size, v = (to_y - y) / size;
  pen.strokeStyle = pen.fillStyle = colour;
  pen.lineWidth = 1.5;
  pen.setLineDash(dash);
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(to_x - head * u, to_y - head * v);
  pen.stroke();
  pen.setLineDash([]);
  pen.beginPath();
  pen.moveTo(to_x, to_y);
  pen.lineTo(to_x - head * u - 0.5 * head * v, to_y - head * v + 0.5 * head * u);
  pen.lineTo(to_x - head * u + 0.5 * head * v, to_y - head * v - 0.5 * head * u);
  pen.fill();
}

/** The least and the greatest of some lists; what is no number is left out. */
export function reach(...lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/** A canvas of so many pixels of the page, cleared, and its pen. */
export function cleared(canvas, width, height, font) {
  const scale = window.devicePixelRatio || 1, size = [Math.round(scale * width), Math.round(scale * height)];
  if (canvas.width !== size[0] || canvas.height !== size[1]) {
    [canvas.width, canvas.height] = size;
    canvas.style.height = `${height}px`;
  }
  const pen = canvas.getContext("2d", { alpha: false });
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  pen.fillStyle = "white";
  pen.fillRect(0, 0, width, height);
  pen.font = `${font}px system-ui, "Segoe UI", "DejaVu Sans", sans-serif`;
  pen.lineJoin = "bevel";
  return pen;
}
