/* Numbers and pictures of a frame: a strip of numbers, and on one canvas surfaces, pressure and load curve, one below the other.

All of it is painted in one go once for each frame, and nothing on the page is laid out anew for it: what a slider that is dragged leaves
time for, where a browser paints without a graphics processor. `canvas.frames` counts what was painted, `canvas.across` is what the upper
pictures show. */

const BODY = "#7a7a7a", SURFACE = "#1f5a92", PRESSURE = "#b3261e", UNDER = "rgba(179, 38, 30, 0.2)", ZONE = "rgba(242, 193, 78, 0.25)";
const GRID = "#e6e6e6", FRAME = "#b0b0b0", INK = "#333333";
const HEIGHT = 250, LEFT = 80, RIGHT = 14, TOP = 24, BOTTOM = 40; // of a picture, and of what stands about it [px]
const USED = 0.5, ROOM = 0.08; // of a range, at least; of what it shows, to either side
const APART = [90, 40]; // numbers along the axes, at least [px]
const LEAST = 4; // of a stretch that is marked [px]

/** A range that shows all: the last one where it does and half of it is used, so that what grows is seen to grow. */
function fitted(last, low, high) {
  if (last && last.low <= low && high <= last.high && high - low >= USED * (last.high - last.low)) return last;
  const room = ROOM * (high - low) || 1;
  return { low: low - room, high: high + room };
}

/** Round values in a range, no more than so many, and what to write at them. */
function ticks({ low, high }, most) {
  const power = 10 ** Math.floor(Math.log10((high - low) / most));
  const step = power * [1, 2, 5, 10].find(times => times * power * most >= high - low);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const first = Math.ceil(low / step), values = Array.from({ length: Math.floor(high / step) - first + 1 }, (_, k) => (first + k) * step);
  return values.map(value => [value, value.toFixed(digits).replace(/^-(?=.*[1-9])/, "\u2212")]);
}

/** Axes of a picture, the first, second or third; across and up on the canvas of what is drawn within, and its pen. */
function axes(pen, place, width, across, up, names) {
  const box = { left: LEFT, right: width - RIGHT, top: place * HEIGHT + TOP, bottom: (place + 1) * HEIGHT - BOTTOM };
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
  for (const [value, text] of ticks(across, (box.right - box.left) / APART[0])) {
    const x = Math.round(at.x(value)) + 0.5;
    pen.moveTo(x, box.top);
    pen.lineTo(x, box.bottom);
    pen.fillText(text, x, box.bottom + 6);
  }
  pen.fillText(names[0], 0.5 * (box.left + box.right), box.bottom + 24);
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [value, text] of ticks(up, (box.bottom - box.top) / APART[1])) {
    const y = Math.round(at.y(value)) + 0.5;
    pen.moveTo(box.left, y);
    pen.lineTo(box.right, y);
    pen.fillText(text, box.left - 6, y);
  }
  pen.stroke();
  pen.strokeStyle = FRAME;
  pen.strokeRect(box.left + 0.5, box.top + 0.5, box.right - box.left, box.bottom - box.top);
  pen.save();
  pen.translate(16, 0.5 * (box.top + box.bottom));
  pen.rotate(-0.5 * Math.PI);
  pen.textAlign = "center";
  pen.fillText(names[1], 0, 0);
  pen.restore();
  return at;
}

/** What is painted stays within the box. */
function within(pen, { box }, paint) {
  pen.save();
  pen.beginPath();
  pen.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
  pen.clip();
  paint();
  pen.restore();
}

/** A line, cut where it has no value. */
function line(pen, at, x, y, colour, width) {
  pen.strokeStyle = colour;
  pen.lineWidth = width;
  pen.beginPath();
  let is_down = false;
  for (let i = 0; i < x.length; i++) {
    if (Number.isNaN(y[i])) is_down = false;
    else if (is_down) pen.lineTo(at.x(x[i]), at.y(y[i]));
    else pen.moveTo(at.x(x[i]), at.y(y[i])), is_down = true;
  }
  pen.stroke();
}

function area(pen, at, x, y, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.moveTo(at.x(x[0]), at.y(0));
  for (let i = 0; i < x.length; i++) pen.lineTo(at.x(x[i]), at.y(y[i]));
  pen.lineTo(at.x(x[x.length - 1]), at.y(0));
  pen.fill();
}

function strips(pen, at, zones) {
  pen.fillStyle = ZONE;
  for (let i = 0; i < zones.length; i += 2) {
    const left = at.x(zones[i]);
    pen.fillRect(left, at.box.top, at.x(zones[i + 1]) - left, at.box.bottom - at.box.top);
  }
}

function dot(pen, x, y, radius, colour) {
  pen.fillStyle = colour;
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fill();
}

/** What the lines of the first picture are, above it. */
function legend(pen, right, entries) {
  pen.textAlign = "right";
  pen.textBaseline = "middle";
  for (const [text, colour] of [...entries].reverse()) {
    pen.fillStyle = colour;
    pen.fillText(text, right, TOP - 12);
    right -= pen.measureText(text).width + 6;
    pen.fillRect(right - 18, TOP - 14, 18, 3);
    right -= 34;
  }
}

/** The least and the greatest of some lists, what is no number left out. */
function reach(...lists) {
  let low = Infinity, high = -Infinity;
  for (const list of lists) {
    for (const value of list) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return [low, high];
}

/** The rows of the fields from one place to another, and one beyond either. */
function rows_between(fields, { low, high }) {
  const [count, length] = fields.shape;
  const row = k => new Float64Array(fields.buffer, fields.byteOffset + 8 * k * length, length);
  const x = row(0), from = x.findIndex(value => value >= low), to = x.findLastIndex(value => value <= high);
  return Array.from({ length: count }, (_, k) => row(k).subarray(Math.max(0, from - 1), to + 2));
}

function paint(pen, width, frame, curve, ranges, across) {
  const [along, height, push] = frame.names;
  const [x, body, surface, touching, pressure] = rows_between(frame.fields, across);
  const fit = (name, low, high) => (ranges[name] = fitted(ranges[name], low, high));

  const top = axes(pen, 0, width, across, fit(height, ...reach(body, surface)), ["", height]);
  within(pen, top, () => {
    strips(pen, top, frame.zones);
    line(pen, top, x, body, BODY, 1.5);
    line(pen, top, x, surface, SURFACE, 1.5);
    line(pen, top, x, touching, PRESSURE, 3);
  });
  legend(pen, width - RIGHT, [["profile", BODY], ["deformed surface", SURFACE], ["contact", PRESSURE]]);

  const bottom = axes(pen, 1, width, across, fit(push, ...reach(pressure, [0])), [along, push]);
  within(pen, bottom, () => {
    strips(pen, bottom, frame.zones);
    area(pen, bottom, x, pressure, UNDER);
    line(pen, bottom, x, pressure, PRESSURE, 1.5);
  });

  const [ways, loads] = curve.points, [way, load] = frame.here, { names } = curve;
  const at = axes(pen, 2, width, fit(names[0], ...reach(ways, [way, 0])), fit(names[1], ...reach(loads, [load, 0])), names);
  within(pen, at, () => {
    line(pen, at, ways, loads, SURFACE, 1.5);
    for (let i = 0; i < ways.length; i++) dot(pen, at.x(ways[i]), at.y(loads[i]), 2, SURFACE);
    dot(pen, at.x(way), at.y(load), 5.5, PRESSURE);
  });
}

/** The numbers of a frame; only what has changed is written. */
function write(strip, numbers) {
  while (strip.children.length < numbers.length) {
    const cell = strip.appendChild(document.createElement("div"));
    cell.append(document.createElement("dt"), document.createElement("dd"));
  }
  while (strip.children.length > numbers.length) strip.lastChild.remove();
  numbers.forEach((said, i) => {
    [...strip.children[i].children].forEach((part, k) => {
      if (part.textContent !== said[k]) part.textContent = said[k];
    });
  });
}

export function render({ model }) {
  const root = document.createElement("div"), head = root.appendChild(document.createElement("div"));
  const refused = head.appendChild(document.createElement("p")), strip = head.appendChild(document.createElement("dl"));
  const doubts = head.appendChild(document.createElement("div")), canvas = root.appendChild(document.createElement("canvas"));
  head.className = "head";
  refused.className = "refused";
  refused.setAttribute("role", "alert");
  canvas.title = "drag to enlarge a stretch, with Shift to move it; double click for all";
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", "surfaces, pressure and load curve");
  canvas.frames = 0;
  const pen = canvas.getContext("2d", { alpha: false });
  // across: what the upper pictures show; view: the same where a hand has chosen it; hand: while it does.
  let ranges = {}, across = null, view = null, hand = null, along = "", is_due = false;

  /** What stands between two places on the canvas; no less than rounding leaves of it. */
  function stretch({ low, high }, left, right) {
    const scale = (high - low) / (root.clientWidth - LEFT - RIGHT), middle = low + scale * (0.5 * (left + right) - LEFT);
    const half = Math.max(0.5 * scale * (right - left), 1e-9 * (Math.abs(middle) + high - low));
    return { low: middle - half, high: middle + half };
  }

  function draw() {
    is_due = false;
    const frame = model.frame, scale = window.devicePixelRatio || 1, width = root.clientWidth;
    if (!frame.names || !width) return;
    if (frame.names[0] !== along) [along, view] = [frame.names[0], null];
    const size = [Math.round(scale * width), Math.round(scale * 3 * HEIGHT)];
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    pen.fillStyle = "white";
    pen.fillRect(0, 0, width, 3 * HEIGHT);
    pen.font = "12px sans-serif";
    pen.lineJoin = "bevel";
    const { fields } = frame;
    across = view ?? { low: fields[0], high: fields[fields.shape[1] - 1] };
    paint(pen, width, frame, model.curve, ranges, across);
    if (hand && !hand.moves) {
      pen.fillStyle = "rgba(31, 90, 146, 0.15)";
      pen.fillRect(hand.from, 0, hand.to - hand.from, 2 * HEIGHT);
    }
    canvas.frames += 1;
    canvas.across = across;
  }

  function due() {
    if (!is_due) requestAnimationFrame(draw);
    is_due = true;
  }

  function show() {
    if (model.frame.numbers) write(strip, model.frame.numbers);
    const said = model.frame.warnings ?? [];
    doubts.replaceChildren(...said.map(text => Object.assign(document.createElement("p"), { className: "warning", textContent: text })));
    due();
  }

  function refuse() {
    refused.textContent = model.refused;
    refused.hidden = !model.refused;
    strip.classList.toggle("old", Boolean(model.refused));
  }

  canvas.onpointerdown = ({ offsetX, offsetY, shiftKey, pointerId }) => {
    if (!across || offsetY > 2 * HEIGHT) return;
    canvas.setPointerCapture(pointerId);
    hand = { from: offsetX, to: offsetX, moves: shiftKey, held: across };
  };
  canvas.onpointermove = ({ offsetX }) => {
    if (!hand) return;
    hand.to = offsetX;
    if (hand.moves) view = stretch(hand.held, LEFT + hand.from - offsetX, root.clientWidth - RIGHT + hand.from - offsetX);
    due();
  };
  canvas.onpointerup = () => {
    const { from, to, moves, held } = hand ?? { moves: true };
    if (!moves && Math.abs(to - from) >= LEAST) [view, ranges] = [stretch(held, Math.min(from, to), Math.max(from, to)), {}];
    hand = null;
    due();
  };
  canvas.ondblclick = () => {
    [view, ranges] = [null, {}];
    due();
  };
  model.on("frame", show);
  model.on("curve", due);
  model.on("refused", refuse);
  new ResizeObserver(due).observe(root);
  refuse();
  show();
  return root;
}
