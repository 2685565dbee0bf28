/* The load curve, and the present scene on it. Its axes are those of the whole curve: they stay while the scene moves along it. */

import { arrow, axes, cleared, dot, fitted, frame as outline, legend, multiple, reach, sizes, within } from "./axes.js";

const ADVANCING = "#1f5a92", RECEDING = "#3d7a4a", JUMP = "#8a5a00", HERE = "#b3261e";

/** A curve through points, in the directions of their slopes. Where a slope is not known, the curve does not overshoot (F. N. Fritsch,
    R. E. Carlson, 1980). */
function smooth(pen, at, points, colour, dash) {
  const x = points.map(point => at.x(point[0])), y = points.map(point => at.y(point[1])), n = x.length;
  const steep = (at.y(1) - at.y(0)) / (at.x(1) - at.x(0)); // of a slope of 1, on the screen
  pen.strokeStyle = colour;
  pen.lineWidth = 2;
  pen.setLineDash(dash);
  pen.beginPath();
  pen.moveTo(x[0], y[0]);
  const step = x.slice(1).map((value, k) => Math.max(Math.hypot(value - x[k], y[k + 1] - y[k]), 1e-9));
  const rates = values => {
    const slope = step.map((size, k) => (values[k + 1] - values[k]) / size);
    return values.map((_, k) => {
      if (k === 0 || k === n - 1) return slope[Math.min(k, n - 2)];
      const [a, b] = [slope[k - 1], slope[k]], [p, q] = [step[k - 1], step[k]];
      return a * b <= 0 ? 0 : 3 * (p + q) / ((2 * q + p) / a + (q + 2 * p) / b);
    });
  };
  const along = rates(x), up = rates(y);
  points.forEach((point, k) => {
    if (point[2] === null) return;
    const next = Math.min(k + 1, n - 1), last = Math.max(k - 1, 0), slope = steep * point[2], size = Math.hypot(1, slope);
    const sign = (x[next] - x[last]) + slope * (y[next] - y[last]) < 0 ? -1 : 1;
    [along[k], up[k]] = [sign / size, sign * slope / size];
  });
  for (let k = 0; k < n - 1; k++) {
    const third = step[k] / 3;
    pen.bezierCurveTo(x[k] + third * along[k], y[k] + third * up[k], x[k + 1] - third * along[k + 1], y[k + 1] - third * up[k + 1], x[k + 1], y[k + 1]);
  }
  pen.stroke();
  pen.setLineDash([]);
}

export class LoadCurve {
  constructor(canvas) {
    Object.assign(this, { canvas, here: null, names: null, found: null, is_due: false });
    this.forget();
    new ResizeObserver(() => this.due()).observe(canvas.parentElement);
  }

  /** The curve is that of another scene. */
  forget() {
    this.found = null;
    this.ranges = {};
    this.due();
  }

  show(frame) {
    [this.here, this.names] = [frame.here, frame.curve_names];
    this.due();
  }

  take(found) {
    this.found = found;
    if (found.done) this.ranges = {};
    this.due();
  }

  due() {
    if (!this.is_due) requestAnimationFrame(() => this.draw());
    this.is_due = true;
  }

  draw() {
    this.is_due = false;
    const { canvas, here, names, found } = this, width = canvas.parentElement.clientWidth;
    if (!here || !width) return;
    const size = sizes(width), pen = cleared(canvas, width, size.height + 20, size.font);
    const lines = found ? [...found.advancing, ...found.receding] : [], points = lines.flat();
    const of = k => points.map(point => point[k]), [left, right] = reach(of(0), [here[0], 0]), [low, high] = reach(of(1), [here[1], 0]);
    const [along, up] = [multiple(Math.max(-left, right), names[0][1]), multiple(Math.max(-low, high), names[1][1])];
    const scaled = ([x, y, slope = null]) => [along[0] * x, up[0] * y, slope === null ? null : slope * up[0] / along[0]];
    this.ranges.x = fitted(this.ranges.x, along[0] * left, along[0] * right, [left < 0 ? 0.05 : 0, 0.04]);
    this.ranges.y = fitted(this.ranges.y, up[0] * low, up[0] * high, [low < 0 ? 0.08 : 0, 0.08]);
    const titles = [`${names[0][0]}${along[1] && ` [${along[1]}]`}`, `${names[1][0]}${up[1] && ` [${up[1]}]`}`];
    const box = { left: size.left, right: width - size.right, top: size.top, bottom: size.height + 20 - size.bottom };
    const at = axes(pen, box, this.ranges.x, this.ranges.y, titles, size);
    within(pen, at, () => {
      for (const line of found?.receding ?? []) if (line.length > 1) smooth(pen, at, line.map(scaled), RECEDING, [7, 4]);
      for (const line of found?.advancing ?? []) if (line.length > 1) smooth(pen, at, line.map(scaled), ADVANCING, []);
      for (const jump of found?.jumps ?? []) {
        const [from, to] = jump.map(scaled).map(([x, y]) => [at.x(x), at.y(y)]);
        if (Math.hypot(to[0] - from[0], to[1] - from[1]) > 8) arrow(pen, from, to, JUMP, 7, [3, 3]);
      }
      const [x, y] = scaled(here);
      dot(pen, at.x(x), at.y(y), 5.5, HERE);
    });
    outline(pen, at);
    const entries = [["load curve", ADVANCING], ["this scene", HERE]];
    if (found?.receding.length) entries.splice(0, 1, ["advancing", ADVANCING], ["receding", RECEDING, [5, 3]], ["jump", JUMP, [3, 3]]);
    legend(pen, box.right, box.top - 13, entries);
    canvas.points = points.length;
  }
}
