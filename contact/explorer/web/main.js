/* The page: sliders ask the server for frames, one after the other. When nothing has changed for a moment, the scene is solved to the page's
   tolerance, and the load curve is asked for. `data-rest` of the body tells that what is shown is at rest. */

import { quantity } from "./axes.js";
import { LoadCurve } from "./curve.js";
import { Pictures } from "./pictures.js";

const REST = 200; // without a change, after which a scene is at rest [ms]
const BUSY = 250; // after which a request counts as slow [ms]
const one = selector => document.querySelector(selector);
const refused = one("#refused"), strip = one("dl"), warnings = one("#warnings"), text = one("textarea");
const state = { session: "", values: {}, about: "", close: null, version: 0, changed: 0, is_fine: true, curve: 0, drawn: 0 };
let is_live = false, is_idle = false;

const pictures = new Pictures(one("#contact"), () => {
  name_button();
  change();
});
const curve = new LoadCurve(one("#curve"));

/** The bytes of the server's reply. A request that takes longer than a moment, and that a person waits for, shows a bar at the top. */
async function bytes_of(request) {
  const waited = request.ask === "curve" ? 0 : setTimeout(() => document.body.classList.add("busy"), BUSY);
  try {
    const answer = await fetch("ask", { method: "POST", body: JSON.stringify({ ...request, session: state.session }) });
    return await answer.arrayBuffer();
  } finally {
    clearTimeout(waited);
    document.body.classList.remove("busy");
  }
}

/** The server's reply: a JSON object, and arrays of numbers. */
async function ask(request) {
  const bytes = await bytes_of(request), length = Number(new DataView(bytes).getBigUint64(0, true));
  const reply = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 8, length)));
  let from = 8 + length;
  for (const [name, shape] of Object.entries(reply.arrays)) {
    const count = shape.reduce((product, size) => product * size, 1);
    reply[name === "below" ? "below_values" : name] = new Float64Array(bytes, from, count);
    from += 8 * count;
  }
  state.session = reply.session;
  return reply;
}

const chosen = name => one(`input[name="${name}"]:checked`).value;

function frame_request(fine) {
  const { view, frame, inner } = pictures, stretch = view && frame ? [view.low / frame.along, view.high / frame.along] : null;
  const columns = Math.round((inner?.width ?? 600) / 3);
  return { ask: "frame", fine, values: state.values, branch: chosen("branch"), below: chosen("below"), stretch, columns };
}

/** Something has changed: ask for frames until the last change is shown. */
async function change() {
  state.changed = performance.now();
  state.version += 1;
  state.is_fine = false;
  document.body.dataset.rest = "no";
  if (is_live) return;
  is_live = true;
  try {
    for (let version = -1; version !== state.version;) {
      version = state.version;
      take(await ask(frame_request(false)));
    }
  } catch (error) {
    lost(error);
  } finally {
    is_live = false;
  }
  idle();
}

/** What is left to do while nothing changes. */
async function idle() {
  if (is_idle) return;
  is_idle = true;
  try {
    while (!is_live) {
      const version = state.version, wait = state.changed + REST - performance.now();
      if (!state.is_fine && wait > 0) {
        await new Promise(done => setTimeout(done, wait));
      } else if (!state.is_fine) {
        const reply = await ask(frame_request(true));
        if (reply.dropped || version !== state.version) continue;
        state.is_fine = true;
        take(reply);
        document.body.dataset.rest = "yes";
      } else if (state.drawn !== state.curve) {
        const reply = await ask({ ask: "curve" });
        if (reply.dropped || reply.curve !== state.curve) continue;
        if (reply.refused || reply.done) state.drawn = state.curve;
        if (!reply.refused) curve.take(reply);
      } else break;
    }
  } catch (error) {
    lost(error);
  } finally {
    is_idle = false;
  }
}

function lost(error) {
  refuse(`The server does not answer any more (${error.message}).`);
}

function refuse(message) {
  refused.textContent = message;
  refused.hidden = !message;
  strip.classList.toggle("old", Boolean(message));
}

/** Show a frame, or say why there is none. */
function take(reply) {
  if (reply.refused) {
    refuse(`${reply.refused}${pictures.frame ? " What is drawn, and the numbers, are of the last scene that was solved." : ""}`);
    return;
  }
  if (!reply.names) return;
  refuse("");
  write(reply.numbers);
  warnings.replaceChildren(...reply.warnings.map(said => Object.assign(document.createElement("p"), { textContent: said })));
  const what = one("#what"), title = [state.about, reply.title].filter(Boolean).join(" \u2013 ");
  if (what.textContent !== title) what.textContent = title;
  if (reply.text !== undefined) {
    text.value = reply.text;
    state.close = reply.close;
    name_button();
  }
  if (reply.curve !== state.curve) {
    state.curve = reply.curve;
    curve.forget();
  }
  pictures.show(reply);
  curve.show(reply);
}

/** The button that shows the largest pressure, or all again. */
function name_button() {
  const button = one("#close");
  button.hidden = !state.close && !pictures.view;
  button.textContent = pictures.view ? "show all" : "enlarge the largest pressure";
}

/** The numbers of a frame; only what has changed is written. */
function write(numbers) {
  while (strip.children.length < numbers.length) {
    strip.appendChild(document.createElement("div")).append(document.createElement("dt"), document.createElement("dd"));
  }
  while (strip.children.length > numbers.length) strip.lastChild.remove();
  numbers.forEach((said, i) => {
    [...strip.children[i].children].forEach((part, k) => {
      if (part.textContent !== said[k]) part.textContent = said[k];
    });
  });
}

/** A slider for one number of the scene. */
function slider(known, steps) {
  const label = document.createElement("label"), head = label.appendChild(document.createElement("span"));
  const input = label.appendChild(document.createElement("input")), shown = document.createElement("output");
  const { low, high, log, whole, unit } = known;
  const place = value => steps * (log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));
  const value_at = at => (log ? low * (high / low) ** (at / steps) : low + (high - low) * at / steps);
  const start = place(whole ? low : known.value);
  head.append(known.label, shown);
  Object.assign(input, { type: "range", min: 0, max: steps, step: "any", value: start, name: known.name });
  const show = value => {
    shown.textContent = whole ? (value < low + 0.5 ? "as it is" : value.toFixed(0)) : quantity(value, unit);
  };
  show(whole ? low : known.value);
  input.oninput = () => {
    const at = Number(input.value), value = Number((whole ? Math.round(value_at(at)) : value_at(at)).toPrecision(4));
    const is_start = Math.abs(at - start) < 0.5 || (whole && value < low + 0.5);
    if (is_start) delete state.values[known.name];
    else state.values[known.name] = value;
    show(is_start ? (whole ? low : known.value) : value);
    change();
  };
  return label;
}

/** Begin with a preset, a text, or the scene that the server was given. */
async function begin(scene) {
  let reply;
  for (const button of document.querySelectorAll("#presets button")) {
    button.setAttribute("aria-pressed", String(button.textContent === (scene.preset ?? (scene.text === undefined ? "given scene" : ""))));
  }
  document.body.dataset.rest = "no";
  try {
    reply = await ask({ ask: "begin", ...scene });
  } catch (error) {
    lost(error);
    return;
  }
  if (reply.refused) {
    take(reply);
    return;
  }
  Object.assign(state, { values: {}, curve: -1, drawn: 0, about: reply.about });
  one("#sliders").replaceChildren(...reply.sliders.map(known => slider(known, reply.steps)));
  one("#branch").hidden = !reply.branches;
  one('input[name="branch"][value="advancing"]').checked = true;
  const names = reply.own ? ["", ...reply.presets] : reply.presets;
  one("#presets").replaceChildren(...names.map(name => {
    const button = Object.assign(document.createElement("button"), { textContent: name || "given scene" });
    button.setAttribute("aria-pressed", String(name === reply.preset && scene.text === undefined));
    button.onclick = () => begin(name ? { preset: name } : {});
    return button;
  }));
  pictures.forget();
  [pictures.view, state.close] = [null, null];
  name_button();
  curve.forget();
  change();
}

for (const input of document.querySelectorAll('input[name="below"], input[name="branch"]')) {
  input.onchange = () => {
    pictures.top = null;
    change();
  };
}
one("#solve").onclick = () => begin({ text: text.value });
one("#close").onclick = () => pictures.look(pictures.view ? null : { low: state.close[0], high: state.close[1] });
one("#copy").onclick = () => navigator.clipboard.writeText(text.value);
const wanted = new URLSearchParams(location.search).get("preset");
begin(wanted ? { preset: wanted } : {});
