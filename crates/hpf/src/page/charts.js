// Charts over time with one cursor, and the learning curve.

const CHARTS = [];
/** The stretch of time that all charts show; null for all. */
let zoomed = null;

const QUANTITIES = [
  { key: "position", title: "Position", unit: "position", also: "reference_position" },
  { key: "force", title: "Force on the tool", unit: "force" },
  { key: "stiffness", title: "Stiffness", unit: "stiffness" },
  { key: "damping", title: "Damping", unit: "damping" },
  { key: "velocity", title: "Velocity", unit: "velocity" },
];

/** Holes where a number is none: the chart leaves a gap. */
const column = (values) => Array.from(values, (value) => (Number.isFinite(value) ? value : null));

/** The motions that charts show: of every run, the snapshot, the task moved by hand. */
function motions() {
  const many = RUNS.length > 1;
  const all = RUNS.map((one, i) => ({ label: many ? one.name : "", trace: one.trace, outline: one.outline, of: i }));
  const snapshot = run().snapshots[STATE.snapshot];
  if (snapshot) all.push({ label: `update ${snapshot.update}`, trace: snapshot.trace, outline: run().outline, dash: [2, 3], of: 5 });
  if (STATE.changed && STATE.changed.learned) {
    all.push({ label: "moved", trace: STATE.changed.learned.trace, outline: STATE.changed.outline, dash: [7, 3], of: 6 });
  }
  return all.filter((one) => one.trace);
}

/** The lines of a quantity: label, unit, time, values, colour, dash. */
function lines(quantity) {
  const chosen = $("axis").value;
  const found = [];
  const many = RUNS.length > 1;
  for (const motion of motions()) {
    motion.outline.axes.forEach((axis, a) => {
      if ((chosen !== "all" && Number(chosen) !== a) || !motion.trace.axes[a]) return;
      const unit = UNITS[axis.unit][quantity.unit];
      const name = motion.label ? `${axis.name}, ${motion.label}` : axis.name;
      const stroke = motion.dash || many ? motion.of * 2 + a : a;
      const values = motion.trace.axes[a][quantity.key];
      found.push({ label: name, unit, time: motion.trace.time, values, stroke, dash: motion.dash });
      if (quantity.also && !motion.dash && !many) {
        const label = `${name}, reference`;
        found.push({ label, unit, time: motion.trace.time, values: motion.trace.axes[a][quantity.also], stroke, dash: [4, 4], thin: true });
      }
    });
  }
  return found;
}

/** The lines of a signal of the contact. */
function contactLines(key, unit) {
  return motions().filter((motion) => motion.trace.contact).map((motion) => ({
    label: motion.label || "contact", unit, time: motion.trace.time, values: motion.trace.contact[key],
    stroke: motion.of, dash: motion.dash,
  }));
}

/** What a chart of `lines` is to uPlot. */
function options(title, found, width, height) {
  const axis = { stroke: colour("quiet"), grid: { stroke: colour("grid"), width: 1 }, ticks: { stroke: colour("grid"), width: 1 }, font: "12px system-ui" };
  const units = [...new Set(found.map((line) => line.unit))].join(", ");
  const shown = (unit) => (_, value) => (value == null ? "–" : `${number(value)} ${unit}`);
  return {
    width, height, title: `${title} [${units}]`,
    cursor: { sync: { key: "time", setSeries: false }, drag: { x: true, y: false } },
    scales: { x: { time: false } },
    axes: [{ ...axis, size: 28 }, { ...axis, size: 62, values: (_, all) => all.map(number) }],
    series: [
      { label: "time", value: shown("s") },
      ...found.map((line) => ({
        label: line.label, value: shown(line.unit), stroke: series(line.stroke), width: line.thin ? 1 : 2, dash: line.dash, points: { show: false },
      })),
    ],
    hooks: {
      setScale: [(chart, key) => key === "x" && follow(chart)],
      setCursor: [(chart) => lookAt(chart)],
    },
  };
}

/** Brings the other charts to the stretch of time of `chart`. */
let isFollowing = false;
function follow(chart) {
  if (isFollowing || !CHARTS.includes(chart)) return;
  isFollowing = true;
  const { min, max } = chart.scales.x;
  zoomed = { min, max };
  CHARTS.filter((other) => other !== chart).forEach((other) => other.setScale("x", { min, max }));
  isFollowing = false;
}

/** The time under the pointer is the time of the scene. */
let isPlaced = false;
function lookAt(chart) {
  if (isPlaced || STATE.playing || STATE.touch || chart.cursor.left < 0 || chart.cursor.event == null) return;
  const time = chart.posToVal(chart.cursor.left, "x");
  if (Number.isFinite(time)) setTime(time, false);
}

/** Puts the cursor of all charts at the time of the scene. */
function placeCursor(time) {
  isPlaced = true;
  for (const chart of CHARTS) {
    chart.setCursor({ left: chart.valToPos(time, "x"), top: chart.over.clientHeight / 2 }, false);
  }
  isPlaced = false;
}

/** The width of a chart in `holder` [px]; on paper, which is laid out after it is drawn, `onPaper`. */
function roomIn(holder, onPaper) {
  return "printed" in document.documentElement.dataset ? onPaper : Math.max(240, holder.clientWidth);
}

/** One table of the lines: times of all, values of each. */
function table(found) {
  const tables = found.map((line) => [column(line.time), column(line.values)]);
  const isSame = tables.every(([time]) => time.length === tables[0][0].length && time.every((t, i) => t === tables[0][0][i]));
  return isSame ? [tables[0][0], ...tables.map(([, values]) => values)] : uPlot.join(tables);
}

function drawCharts() {
  const place = $("charts");
  CHARTS.splice(0).forEach((chart) => chart.destroy());
  place.replaceChildren();
  const drawn = QUANTITIES.map((quantity) => [quantity.title, lines(quantity)]);
  drawn.push(["Contact force", contactLines("force", "N")], ["Deviation from the contact's curve", contactLines("deviation", "m")]);
  const shown = drawn.filter(([, found]) => found.length);
  // A chart is as wide as its place among all of them.
  const holders = shown.map(([title]) => el("figure", { class: "chart", "aria-label": `${title} over time` }));
  place.append(...holders);
  const widths = holders.map((holder) => roomIn(holder, 340));
  shown.forEach(([title, found], i) => {
    CHARTS.push(new uPlot(options(title, found, widths[i], 190), table(found), holders[i]));
  });
  if (zoomed && CHARTS.length) CHARTS[0].setScale("x", zoomed);
}

let learningChart = null;
function drawLearning() {
  const place = $("learning");
  if (learningChart) learningChart.destroy();
  learningChart = null;
  place.replaceChildren();
  const rows = (one) => ({ label: one.name, x: one.learning.rollouts, y: one.learning.total });
  const found = RUNS.filter((one) => one.learning && one.learning.total.length > 0).map(rows);
  if (STATE.changed && STATE.changed.rows.length) {
    found.push({ label: "moved", x: STATE.changed.rows.map((row) => row.rollouts), y: STATE.changed.rows.map((row) => row.total) });
  }
  $("learning-section").hidden = !found.length;
  if (!found.length) return;
  const positive = (values) => Array.from(values, (value) => (Number.isFinite(value) && value > 0 ? value : null));
  const tables = found.map((one) => [column(one.x), positive(one.y)]);
  const hasCost = tables.some(([, values]) => values.some((value) => value != null));
  const axis = { stroke: colour("quiet"), grid: { stroke: colour("grid"), width: 1 }, ticks: { stroke: colour("grid"), width: 1 }, font: "12px system-ui" };
  learningChart = new uPlot({
    width: roomIn(place, 680), height: 220, title: "Cost by motions made",
    scales: { x: { time: false }, y: { distr: hasCost ? 3 : 1 } },
    axes: [{ ...axis, size: 28 }, { ...axis, size: 62, values: (_, all) => all.map((value) => (value == null ? "" : number(value))) }],
    series: [
      { label: "motions", value: (_, value) => (value == null ? "–" : number(value)) },
      ...found.map((one, i) => ({ label: one.label, stroke: series(i), width: 2, value: (_, value) => number(value), points: { show: one.x.length < 60, size: 5, fill: series(i) }, dash: one.label === "moved" ? [7, 3] : undefined })),
    ],
  }, tables.length === 1 ? tables[0] : uPlot.join(tables), place);
}
