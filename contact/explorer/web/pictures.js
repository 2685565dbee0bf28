/* The upper picture: bodies, pressure, and the stress below, over the same x. `canvas.frames` counts what was painted, `canvas.across` is
   the stretch of x that is shown. */

import { QUIET, area, arrow, axes, cleared, fitted, frame as outline, legend, line, multiple, reach, sizes, within } from "./axes.js";
import { image, key, scaled } from "./below.js";

const BODY = "#7a7a7a", SURFACE = "#1f5a92", PRESSURE = "#b3261e", ZONE = "rgba(242, 193, 78, 0.2)";
const MOST_ZONES = 8; // that are tinted
const MOST_ARROWS = 12;
const LEAST = 4; // of a stretch that is marked [px]
const DEEPEST = 440; // picture of the stress [px]

/** The rows of the fields from one place to another, and one beyond either. */
function rows_between(fields, [count, length], { low, high }) {
  const row = k => fields.subarray(k * length, (k + 1) * length);
  const x = row(0), from = x.findIndex(value => value >= low), to = x.findLastIndex(value => value <= high);
  return Array.from({ length: count }, (_, k) => row(k).subarray(Math.max(0, from - 1), to + 2));
}

function strips(pen, at, zones) {
  if (zones.length > 2 * MOST_ZONES) return;
  pen.fillStyle = ZONE;
  for (let i = 0; i < zones.length; i += 2) {
    const left = at.x(zones[i]);
    pen.fillRect(left, at.box.top, at.x(zones[i + 1]) - left, at.box.bottom - at.box.top);
  }
}

function label(pen, text, x, y, colour, align, baseline) {
  pen.save();
  pen.font = pen.font.replace(/^(bold )?/, "bold ");
  pen.fillStyle = colour;
  pen.textAlign = align;
  pen.textBaseline = baseline;
  pen.fillText(text, x, y);
  pen.restore();
}

export class Pictures {
  constructor(canvas, changed) {
    Object.assign(this, { canvas, changed, frame: null, view: null, hand: null, along: "", is_due: false, image: null });
    this.forget();
    canvas.frames = 0;
    canvas.onpointerdown = event => this.press(event);
    canvas.onpointermove = event => this.move(event);
    canvas.onpointerup = () => this.release();
    canvas.onpointercancel = () => { this.hand = null; this.due(); };
    canvas.ondblclick = () => this.look(null);
    new ResizeObserver(() => this.due()).observe(canvas.parentElement);
  }

  /** Ranges of the axes are chosen anew. */
  forget() {
    this.ranges = {};
    this.top = null;
  }

  show(frame) {
    if (frame.names[0] !== this.along) [this.along, this.view] = [frame.names[0], null];
    this.frame = frame;
    this.image = null;
    this.due();
  }

  /** Show a stretch of x, or all. */
  look(view) {
    this.view = view;
    this.ranges = {};
    this.due();
    this.changed();
  }

  due() {
    if (!this.is_due) requestAnimationFrame(() => this.draw());
    this.is_due = true;
  }

  fit(name, low, high, room) {
    return (this.ranges[name] = fitted(this.ranges[name], low, high, room));
  }

  draw() {
    this.is_due = false;
    const { canvas, frame } = this, width = canvas.parentElement.clientWidth;
    if (!frame || !width) return;
    const size = sizes(width), { below } = frame, [count, length] = frame.arrays.fields, fields = frame.fields;
    const across = this.view ?? { low: fields[0], high: fields[length - 1] };
    const inner = width - size.left - size.right;
    const deep = !below ? 0 : below.refused ? 60 : Math.min(DEEPEST, Math.round(inner * below.depth / (below.high - below.low)));
    const height = 2 * size.height + (deep ? deep + size.top + size.bottom : 0);
    const pen = cleared(canvas, width, height, size.font);
    const box = (top, tall) => ({ left: size.left, right: width - size.right, top, bottom: top + tall });
    const [x, body, surface, touching, pressure] = rows_between(fields, frame.arrays.fields, across);
    const inner_height = size.height - size.top - size.bottom;
    this.bodies(pen, box(size.top, inner_height + 16), across, { x, body, surface, touching }, size);
    this.pressure(pen, box(size.height + 12, inner_height + 14), across, x, pressure, size);
    if (deep) this.below(pen, box(2 * size.height + size.top, deep), across, size);
    this.upper = 2 * size.height;
    if (this.hand && !this.hand.moves) {
      pen.fillStyle = "rgba(31, 90, 146, 0.15)";
      pen.fillRect(this.hand.from, 0, this.hand.to - this.hand.from, height);
    }
    canvas.frames += 1;
    canvas.across = across;
    this.inner = { left: size.left, width: inner };
  }

  bodies(pen, box, across, { x, body, surface, touching }, size) {
    const { frame } = this, [low, high] = reach(body, surface);
    const at = axes(pen, box, across, this.fit(frame.names[1], low, high, [0.24, 0.22]), ["", frame.names[1]], size);
    within(pen, at, () => {
      const up = this.ranges[frame.names[1]];
      strips(pen, at, frame.zones);
      area(pen, at, x, body, up.high, "rgba(122, 122, 122, 0.22)");
      area(pen, at, x, surface, up.low, "rgba(31, 90, 146, 0.12)");
      line(pen, at, x, body, BODY, 1.5);
      line(pen, at, x, surface, SURFACE, 1.5);
      line(pen, at, x, touching, PRESSURE, frame.zones.length > 2 * MOST_ZONES ? 2 : 3);
      const zones = frame.zones.filter((_, k) => frame.zones[k & ~1] < across.high && frame.zones[k | 1] > across.low);
      const k = 2 * Math.floor(zones.length / 4), middle = zones.length > 1 ? 0.5 * (zones[k] + zones[k + 1]) : 0.5 * (across.low + across.high);
      const place = Math.min(Math.max(at.x(middle), box.left + 30), box.right - 30);
      label(pen, "body", place, box.top + 6, BODY, "center", "top");
      label(pen, "counter-face", box.left + 8, box.bottom - 6, SURFACE, "left", "bottom");
    });
    outline(pen, at);
    legend(pen, box.right, box.top - 13, [["profile", BODY], ["deformed surface", SURFACE], ["contact", PRESSURE]]);
  }

  pressure(pen, box, across, x, pressure, size) {
    const { frame } = this, [lowest, top] = frame.range, [low, high] = reach(pressure, [0]);
    const range = this.fit(frame.names[2], Math.max(low, lowest), Math.min(high, top) || 1, [low < 0 ? 0.08 : 0, 0.08]);
    const at = axes(pen, box, across, range, [frame.below && !frame.below.refused ? "" : frame.names[0], frame.names[2]], size);
    within(pen, at, () => {
      strips(pen, at, frame.zones);
      area(pen, at, x, pressure, 0, "rgba(179, 38, 30, 0.2)");
      line(pen, at, x, pressure, PRESSURE, 1.5);
      if (low < 0) line(pen, at, [across.low, across.high], [0, 0], "#8c8c8c", 1);
      if (frame.mean !== null && Math.abs(frame.mean) > 0.04 * (range.high - range.low)) {
        line(pen, at, [across.low, across.high], [frame.mean, frame.mean], "#2b2b2b", 1, [6, 4]);
        label(pen, "p\u0304", box.right - 6, at.y(frame.mean) - 3, "#2b2b2b", "right", "bottom");
      }
      this.infinite(pen, at, frame.rising, 1, "p \u2192 \u221e");
      this.infinite(pen, at, frame.falling, -1, "p \u2192 \u2212\u221e");
    });
    outline(pen, at);
  }

  /** Arrows where the pressure tends to infinity, up or down. */
  infinite(pen, at, places, sign, text) {
    const { box } = at, seen = places.filter(x => at.x(x) >= box.left && at.x(x) <= box.right), edge = sign > 0 ? box.top : box.bottom;
    if (!seen.length || seen.length > MOST_ARROWS) return;
    for (const x of seen) arrow(pen, [at.x(x), edge + 22 * sign], [at.x(x), edge + 1 * sign], PRESSURE);
    const first = at.x(seen[0]), on_right = sign > 0 ? first + 70 < box.right : first - 70 < box.left;
    label(pen, text, first + (on_right ? 8 : -8), edge + 6 * sign, PRESSURE, on_right ? "left" : "right", sign > 0 ? "top" : "bottom");
  }

  below(pen, box, across, size) {
    const { below, arrays, zones, names } = this.frame;
    if (below.refused) {
      pen.fillStyle = QUIET;
      pen.textAlign = "left";
      pen.textBaseline = "top";
      wrapped(pen, below.refused, box.left, box.top, box.right - box.left, size.font + 4);
      return;
    }
    this.top = scaled(this.top, below.top);
    const depth = below.depth / this.frame.along, [factor, unit] = multiple(depth, "m"), own = { left: 0, right: box.right - box.left };
    const at = axes(pen, box, across, { low: factor * depth, high: 0 }, [names[0], `depth [${unit}]`], size);
    within(pen, at, () => {
      const wide = Math.round(at.x(below.high) - at.x(below.low)), tall = Math.round(box.bottom - box.top);
      const made = [wide, tall, below.kind, this.top].join();
      if (this.image?.made !== made && wide <= 4 * own.right) {
        this.image = image(this.frame.below_values, arrays.below, Math.min(wide, 1600), tall, below.kind, this.top);
        this.image.made = made;
      }
      if (this.image) pen.drawImage(this.image, at.x(below.low), box.top, wide, tall);
      pen.fillStyle = PRESSURE;
      for (let i = 0; i < zones.length; i += 2) pen.fillRect(at.x(zones[i]), box.top, Math.max(1, at.x(zones[i + 1]) - at.x(zones[i])), 4);
      if (below.peak) this.cross(pen, at, [below.peak[0], factor * below.peak[1] / this.frame.along], across);
    });
    outline(pen, at);
    key(pen, box, box.top - 12, below.kind, this.top, below.infinite);
  }

  cross(pen, at, peak, across) {
    const x = at.x(peak[0]), y = at.y(peak[1]);
    if (peak[0] < across.low || peak[0] > across.high) return;
    for (const [colour, width] of [["white", 4], [SURFACE, 2]]) {
      pen.strokeStyle = colour;
      pen.lineWidth = width;
      pen.beginPath();
      for (const s of [-1, 1]) pen.moveTo(x - 5, y - 5 * s), pen.lineTo(x + 5, y + 5 * s);
      pen.stroke();
    }
  }

  // A stretch is chosen by hand.

  /** What stands between two places on the canvas; no less than rounding leaves of it. */
  stretch({ low, high }, left, right) {
    const scale = (high - low) / this.inner.width, middle = low + scale * (0.5 * (left + right) - this.inner.left);
    const half = Math.max(0.5 * scale * (right - left), 1e-9 * (Math.abs(middle) + high - low));
    return { low: middle - half, high: middle + half };
  }

  press({ offsetX, shiftKey, pointerId, pointerType }) {
    if (!this.canvas.across || pointerType === "touch") return;
    this.canvas.setPointerCapture(pointerId);
    this.hand = { from: offsetX, to: offsetX, moves: shiftKey, held: this.canvas.across };
  }

  move({ offsetX }) {
    const { hand, inner } = this;
    if (!hand) return;
    hand.to = offsetX;
    if (hand.moves) this.view = this.stretch(hand.held, inner.left + hand.from - offsetX, inner.left + inner.width + hand.from - offsetX);
    this.due();
  }

  release() {
    const { from, to, moves, held } = this.hand ?? { moves: true, from: 0, to: 0 };
    this.hand = null;
    if (!moves && Math.abs(to - from) >= LEAST) this.look(this.stretch(held, Math.min(from, to), Math.max(from, to)));
    else if (moves && from !== to) this.changed();
    this.due();
  }
}

function wrapped(pen, text, x, y, width, step) {
  let row = "";
  for (const word of text.split(" ")) {
    const longer = row ? `${row} ${word}` : word;
    if (pen.measureText(longer).width > width && row) {
      pen.fillText(row, x, y);
      [row, y] = [word, y + step];
    } else row = longer;
  }
  pen.fillText(row, x, y);
}
