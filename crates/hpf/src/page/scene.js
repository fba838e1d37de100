// The scene: path, tool, force, stiffness, what is touched and passed; drawn on one canvas.
// Two axes span the plane; a task of one axis is shown over time.

const SCENE = { ratio: 1, width: 0, height: 0, box: [0, 1, 0, 1], hot: null };

/** Whether the horizontal direction is time. */
const isOverTime = () => outline().axes.length === 1;

/** Where a point is on the canvas [px]. */
function toScreen(x, y) {
  const [left, right, bottom, top] = SCENE.box;
  const pad = 34;
  return [
    pad + ((x - left) / (right - left)) * (SCENE.width - 2 * pad),
    SCENE.height - pad - ((y - bottom) / (top - bottom)) * (SCENE.height - 2 * pad),
  ];
}

/** The point of the plane under a point of the canvas. */
function toPlane(px, py) {
  const [left, right, bottom, top] = SCENE.box;
  const pad = 34;
  return [
    left + ((px - pad) / (SCENE.width - 2 * pad)) * (right - left),
    bottom + ((SCENE.height - pad - py) / (SCENE.height - 2 * pad)) * (top - bottom),
  ];
}

/** The points of a motion in the plane. */
function pathOf(trace, key = "position") {
  const [first, second] = STATE.planes;
  if (isOverTime()) return [trace.time, trace.axes[0][key]];
  return [trace.axes[first][key], trace.axes[second][key]];
}

/** A place given by one number per axis, at `time`, in the plane. */
function placeOf(position, time) {
  const [first, second] = STATE.planes;
  return isOverTime() ? [time, position[0]] : [position[first], position[second]];
}

/** Handles that can be dragged: what they are of, and where. */
function handles() {
  const task = outline();
  const end = task.duration;
  const found = [
    { kind: "start", label: "start", at: placeOf(task.axes.map((axis) => axis.start), 0) },
    { kind: "goal", label: "goal", at: placeOf(task.axes.map((axis) => axis.goal), end) },
  ];
  task.via.forEach((via, i) => found.push({ kind: "via", index: i, label: `via ${i + 1}`, at: placeOf(via.position, via.time ?? end / 2) }));
  return found;
}

/** The wall in the plane: which direction it blocks, and where. */
function wall() {
  const { contact, axes } = outline();
  if (!contact || !contact.movable) return null;
  const axis = axes.findIndex((one) => one.name === contact.axis);
  if (isOverTime()) return { across: 1, at: contact.position, direction: contact.direction };
  const across = STATE.planes.indexOf(axis);
  return across < 0 ? null : { across, at: contact.position, direction: contact.direction };
}

/** Fits the view around what is shown. */
function fit() {
  const bounds = [[Infinity, -Infinity], [Infinity, -Infinity]];
  const take = (direction, value) => {
    if (!Number.isFinite(value)) return;
    bounds[direction][0] = Math.min(bounds[direction][0], value);
    bounds[direction][1] = Math.max(bounds[direction][1], value);
  };
  const traces = [shownTrace(), run().trace, ...run().snapshots.map((one) => one.trace)].filter(Boolean);
  for (const trace of traces) pathOf(trace).forEach((values, direction) => values.forEach((value) => take(direction, value)));
  handles().forEach(({ at }) => at.forEach((value, direction) => take(direction, value)));
  const blocked = wall();
  if (blocked) take(blocked.across, blocked.at);
  const spans = bounds.map(([low, high]) => (high > low ? high - low : 0));
  const widest = Math.max(...spans, 1e-9);
  const sides = bounds.map(([low, high], direction) => {
    const span = spans[direction] > (isOverTime() ? 0 : 0.02 * widest) ? spans[direction] : isOverTime() ? 1 : widest;
    const middle = Number.isFinite(low) ? (low + high) / 2 : 0;
    return [middle - 0.6 * span, middle + 0.6 * span];
  });
  // Metres are as long upwards as sideways.
  const room = [SCENE.width - 68, SCENE.height - 68];
  if (!isOverTime()) {
    const scale = Math.max((sides[0][1] - sides[0][0]) / room[0], (sides[1][1] - sides[1][0]) / room[1]);
    sides.forEach((side, direction) => {
      const middle = (side[0] + side[1]) / 2;
      side[0] = middle - 0.5 * scale * room[direction];
      side[1] = middle + 0.5 * scale * room[direction];
    });
  }
  const box = sides.flat();
  if (box.every(Number.isFinite) && box[1] > box[0] && box[3] > box[2]) SCENE.box = box;
}

/** Makes the canvas as sharp as the screen. */
function resizeScene() {
  const canvas = $("scene");
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth || 600;
  const height = Math.round(Math.min(460, Math.max(260, width * 0.62)));
  SCENE.ratio = ratio;
  SCENE.width = width;
  SCENE.height = height;
  canvas.style.height = `${height}px`;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  fit();
}

function drawPath(pen, trace, stroke, width, dash = [], until = Infinity) {
  const [xs, ys] = pathOf(trace);
  pen.beginPath();
  let isOpen = false;
  for (let i = 0; i < xs.length && trace.time[i] <= until; i += 1) {
    if (!Number.isFinite(xs[i]) || !Number.isFinite(ys[i])) {
      isOpen = false;
      continue;
    }
    const [x, y] = toScreen(xs[i], ys[i]);
    if (isOpen) pen.lineTo(x, y);
    else pen.moveTo(x, y);
    isOpen = true;
  }
  Object.assign(pen, { strokeStyle: stroke, lineWidth: width });
  pen.setLineDash(dash);
  pen.stroke();
  pen.setLineDash([]);
}

function drawGrid(pen) {
  const [left, right, bottom, top] = SCENE.box;
  const tick = (low, high) => {
    const raw = (high - low) / 6;
    const unit = 10 ** Math.floor(Math.log10(raw));
    return unit * [1, 2, 5, 10].find((step) => step * unit >= raw);
  };
  Object.assign(pen, { strokeStyle: colour("grid"), lineWidth: 1, fillStyle: colour("quiet"), font: "12px system-ui" });
  const each = (low, high, draw) => {
    const step = tick(low, high);
    for (let i = Math.ceil(low / step); i * step <= high && i < Math.ceil(low / step) + 20; i += 1) draw(i * step);
  };
  const line = (a, b) => {
    pen.beginPath();
    pen.moveTo(...a);
    pen.lineTo(...b);
    pen.stroke();
  };
  pen.textAlign = "center";
  each(left, right, (x) => {
    line(toScreen(x, bottom), toScreen(x, top));
    pen.fillText(number(x), toScreen(x, bottom)[0], SCENE.height - 16);
  });
  pen.textAlign = "left";
  each(bottom, top, (y) => {
    line(toScreen(left, y), toScreen(right, y));
    pen.fillText(number(y), 4, toScreen(left, y)[1] - 3);
  });
  const { axes } = outline();
  const named = (a) => `${axes[a].name} [${axes[a].unit}]`;
  pen.textAlign = "right";
  pen.fillText(isOverTime() ? "time [s]" : named(STATE.planes[0]), SCENE.width - 6, SCENE.height - 3);
  pen.textAlign = "left";
  pen.fillText(isOverTime() ? named(0) : named(STATE.planes[1]), 4, 13);
}

function drawArrow(pen, from, to, stroke) {
  const [dx, dy] = [to[0] - from[0], to[1] - from[1]];
  const length = Math.hypot(dx, dy);
  if (!(length > 3)) return;
  const [ux, uy] = [dx / length, dy / length];
  Object.assign(pen, { strokeStyle: stroke, fillStyle: stroke, lineWidth: 3 });
  pen.beginPath();
  pen.moveTo(...from);
  pen.lineTo(to[0] - 7 * ux, to[1] - 7 * uy);
  pen.stroke();
  pen.beginPath();
  pen.moveTo(...to);
  pen.lineTo(to[0] - 11 * ux - 5 * uy, to[1] - 11 * uy + 5 * ux);
  pen.lineTo(to[0] - 11 * ux + 5 * uy, to[1] - 11 * uy - 5 * ux);
  pen.fill();
}

/** What the tool is doing now: in the hand, or in the motion that is shown. One entry per axis. */
function toolNow() {
  if (STATE.touch) return STATE.touch.now();
  const trace = (run().snapshots[STATE.snapshot] || {}).trace || shownTrace();
  if (!trace) return null;
  const i = sampleAt(trace, STATE.time);
  const of = (key) => trace.axes.map((axis) => axis[key][i]);
  return { time: trace.time[i], position: of("position"), reference: of("reference_position"), force: of("force"), stiffness: of("stiffness"), damping: of("damping") };
}

const PIXELS_PER_NEWTON = 4;
const MOST_ARROW = 130;

function drawTool(pen, now) {
  const [tool, reference] = [placeOf(now.position, now.time), placeOf(now.reference, now.time)].map((place) => toScreen(...place));
  if (![...tool, ...reference].every(Number.isFinite)) return;
  // How softly it is held: the tool gives way by the half axes under the same force; soft is wide.
  const planes = isOverTime() ? [0, 0] : STATE.planes;
  const bounds = outline().axes.map((axis) => axis.stiffness[0]);
  const radius = (a) => 12 + 42 * Math.min(1, Math.max(0, bounds[a] / now.stiffness[a]) || 0);
  const radii = isOverTime() ? [9, radius(0)] : planes.map(radius);
  pen.beginPath();
  pen.ellipse(reference[0], reference[1], radii[0], radii[1], 0, 0, 2 * Math.PI);
  Object.assign(pen, { fillStyle: colour("soft"), strokeStyle: colour("series-2"), lineWidth: 1.5 });
  pen.fill();
  pen.stroke();
  pen.beginPath();
  pen.moveTo(...reference);
  pen.lineTo(...tool);
  Object.assign(pen, { strokeStyle: colour("quiet"), lineWidth: 1.5 });
  pen.setLineDash([3, 3]);
  pen.stroke();
  pen.setLineDash([]);
  const size = (force) => Math.max(-MOST_ARROW, Math.min(MOST_ARROW, PIXELS_PER_NEWTON * force)) || 0;
  const [fx, fy] = isOverTime() ? [0, size(now.force[0])] : planes.map((a) => size(now.force[a]));
  drawArrow(pen, tool, [tool[0] + fx, tool[1] - fy], colour("series-1"));
  pen.beginPath();
  pen.arc(tool[0], tool[1], 8, 0, 2 * Math.PI);
  Object.assign(pen, { fillStyle: colour("series-0"), strokeStyle: colour("paper"), lineWidth: 2 });
  pen.fill();
  pen.stroke();
}

function drawHandles(pen) {
  pen.font = "12px system-ui";
  for (const handle of handles()) {
    const [x, y] = toScreen(...handle.at);
    if (!Number.isFinite(x + y)) continue;
    const isHot = SCENE.hot && SCENE.hot.kind === handle.kind && SCENE.hot.index === handle.index;
    const reach = isHot ? 9 : 7;
    Object.assign(pen, { fillStyle: colour("paper"), strokeStyle: colour(handle.kind === "via" ? "series-2" : "series-1"), lineWidth: 2.5 });
    pen.beginPath();
    if (handle.kind === "via") {
      pen.moveTo(x, y - reach);
      [[reach, 0], [0, reach], [-reach, 0]].forEach(([dx, dy]) => pen.lineTo(x + dx, y + dy));
      pen.closePath();
    } else if (handle.kind === "goal") {
      pen.rect(x - reach + 1, y - reach + 1, 2 * reach - 2, 2 * reach - 2);
    } else pen.arc(x, y, reach - 1, 0, 2 * Math.PI);
    pen.fill();
    pen.stroke();
    pen.fillStyle = colour("ink");
    pen.textAlign = x > SCENE.width - 70 ? "right" : "left";
    pen.fillText(handle.label, x + (x > SCENE.width - 70 ? -12 : 12), y - 8);
  }
}

function drawWall(pen) {
  const blocked = wall();
  if (!blocked) return;
  const [left, right, bottom, top] = SCENE.box;
  const beyond = blocked.direction > 0 ? [right, top][blocked.across] : [left, bottom][blocked.across];
  const corners = blocked.across === 0
    ? [toScreen(blocked.at, top), toScreen(beyond, bottom)]
    : [toScreen(left, blocked.at), toScreen(right, beyond)];
  pen.fillStyle = colour("wall");
  pen.fillRect(corners[0][0], corners[0][1], corners[1][0] - corners[0][0], corners[1][1] - corners[0][1]);
  pen.fillStyle = colour("ink");
  pen.textAlign = "left";
  pen.fillText("wall", Math.min(corners[0][0], corners[1][0]) + 6, Math.min(corners[0][1], corners[1][1]) + 14);
}

function drawScene() {
  const pen = $("scene").getContext("2d");
  pen.setTransform(SCENE.ratio, 0, 0, SCENE.ratio, 0, 0);
  pen.fillStyle = colour("paper");
  pen.fillRect(0, 0, SCENE.width, SCENE.height);
  drawGrid(pen);
  drawWall(pen);
  const snapshot = run().snapshots[STATE.snapshot];
  RUNS.forEach((one, i) => {
    const fits = one.trace && one.trace.axes.length === outline().axes.length;
    if (fits) drawPath(pen, one.trace, i === STATE.run && !STATE.changed ? series(0) : colour("faint"), 2);
  });
  if (STATE.changed && STATE.changed.path) drawPath(pen, STATE.changed.path, series(6), 1.5, [3, 3]);
  if (STATE.changed && STATE.changed.learned) drawPath(pen, STATE.changed.learned.trace, series(0), 2.5);
  if (snapshot) drawPath(pen, snapshot.trace, series(5), 2, [2, 3]);
  drawHandles(pen);
  const now = toolNow();
  if (now) drawTool(pen, now);
  if (STATE.touch) STATE.touch.drawTrail(pen);
}
