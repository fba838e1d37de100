// What all of the page uses: elements, numbers, the data of the runs.

const $ = (id) => document.getElementById(id);

/** An element with attributes, listeners (on...) and children; text is always text. */
function el(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value != null) made.setAttribute(name, String(value));
  }
  made.append(...children.filter((child) => child != null));
  return made;
}

/** A number for people: four digits; a dash for what is no number. */
function number(value) {
  if (value === null || value === undefined || !Number.isFinite(Number(value))) return "–";
  value = Number(value);
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-3) return value.toExponential(3).replace(/\.?0+e/, "e").replace("e+", "e");
  return String(Number(value.toPrecision(4)));
}

/** Numbers of 32 bits, written by the program in base 64, smallest byte first. */
function floats(text) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

const SIGNALS = ["reference_position", "reference_velocity", "position", "velocity", "force", "stiffness", "damping"];
const CONTACT = ["travel", "deflection", "deviation", "force"];

/** A motion as the page holds it, with its columns read. */
function readTrace(packed) {
  if (!packed) return null;
  const axis = (columns) => Object.fromEntries(SIGNALS.map((name) => [name, floats(columns[name])]));
  const trace = { time: floats(packed.time), rest: packed.rest, axes: packed.axes.map(axis), contact: null };
  if (packed.contact) {
    trace.contact = Object.fromEntries(CONTACT.map((name) => [name, floats(packed.contact[name])]));
    trace.contact.axis = packed.contact.axis;
    trace.contact.set_point = packed.contact.set_point;
  }
  return trace;
}

/** The sample of `trace` at `time`. */
function sampleAt(trace, time) {
  let [low, high] = [0, trace.time.length - 1];
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (trace.time[middle] <= time) low = middle;
    else high = middle - 1;
  }
  return low;
}

const DATA = JSON.parse($("data").textContent);
const RUNS = DATA.runs.map((run) => ({
  ...run,
  trace: readTrace(run.trace),
  snapshots: run.snapshots.map(({ update, trace }) => ({ update, trace: readTrace(trace) })),
}));

/** What the page shows now. `changed` is the task as it was moved by hand, and what was learned of it. */
const STATE = { run: 0, snapshot: -1, time: 0, playing: false, speed: 1, changed: null, touch: null, planes: [0, 1] };

const run = () => RUNS[STATE.run];
/** The outline of the task that is shown: as moved by hand, where it was. */
const outline = () => (STATE.changed ? STATE.changed.outline : run().outline);
/** The motion that is shown. */
const shownTrace = () => (STATE.changed && STATE.changed.learned ? STATE.changed.learned.trace : run().trace);
const policyText = () => (STATE.changed && STATE.changed.learned ? STATE.changed.learned.policy : run().policy);

/** Units of stiffness, damping and force of an axis in m or rad. */
const UNITS = {
  m: { position: "m", velocity: "m/s", force: "N", stiffness: "N/m", damping: "N s/m" },
  rad: { position: "rad", velocity: "rad/s", force: "N m", stiffness: "N m/rad", damping: "N m s/rad" },
};

/** A colour of the style sheet. */
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
/** The colour of the i-th thing of one kind; safe for colour-blind readers. */
const series = (i) => colour(`series-${i % 8}`);

/** Says something to the reader, on the screen and to a screen reader. */
function say(message, isBad = false) {
  $("message").textContent = message;
  $("message").classList.toggle("bad", isBad);
}

/** Offers `text` as a file. */
function save(name, text, type) {
  const address = URL.createObjectURL(new Blob([text], { type }));
  const link = el("a", { href: address, download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
