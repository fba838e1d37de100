// The task moved by hand: handles, numbers, and what is learned of it.

/** A number as TOML has it. */
function toml(value) {
  const text = String(value);
  return /[.e]/.test(text) ? text : `${text}.0`;
}

const array = (values) => `[${values.map(toml).join(", ")}]`;
/** To the thousandth of the view: what a hand can mean. */
function rounded(value) {
  const span = Math.max(SCENE.box[1] - SCENE.box[0], SCENE.box[3] - SCENE.box[2]);
  const unit = 10 ** (Math.floor(Math.log10(span)) - 3);
  return Number((Math.round(value / unit) * unit).toPrecision(10));
}

/** Begins to change the task of the run: from now on `auto` learns it. */
function beginChange() {
  if (STATE.changed) return STATE.changed;
  const { task, tables, outline: shown } = run();
  const first = readTask(task, tables);
  // `auto` needs few motions; what PI2 was allowed would let it polish for a long time.
  const begun = shown.method === "auto" ? first : first.with("learning.method", '"auto"').with("learning.max_rollouts", "200");
  STATE.changed = { task: begun, text: begun.text(), outline: JSON.parse(begun.describe()), learned: null, rows: [], path: null };
  $("forget").hidden = $("save-task").hidden = false;
  return STATE.changed;
}

/** Changes keys of the task, each a path and a value in TOML, and learns it. */
function change(changes) {
  let changed;
  try {
    changed = beginChange();
    let task = changed.task;
    for (const [path, value] of changes) task = task.with(path, value);
    Object.assign(changed, { task, text: task.text(), outline: JSON.parse(task.describe()) });
  } catch (error) {
    say(`This change is refused: ${error.message}`, true);
    return false;
  }
  if (STATE.touch) STATE.touch.leave();
  relearn();
  drawScene();
  return true;
}

/** Learns the task as it is now. */
function relearn() {
  const changed = STATE.changed;
  if (!ENGINE.busy) say("Learning …");
  const asked = performance.now();
  let first = null;
  let rows = [];
  learnNext({
    text: changed.text,
    tables: JSON.stringify(run().tables),
    heard(said) {
      if (STATE.changed !== changed) return;
      if (said.kind === "progress") {
        rows.push({ rollouts: said.rollouts, total: said.total });
        if (said.path) {
          first = rows.length > 1 && first === null ? performance.now() - asked : first;
          changed.path = pathTrace(said.path, changed.outline);
          SCENE.isDirty = true;
        }
        say(`Learning: ${said.rollouts} motions, cost ${number(said.total)}`);
        return;
      }
      changed.path = null;
      if (said.kind === "failed") {
        say(`The moved task was not learned: ${said.message}`, true);
        drawScene();
        return;
      }
      if (said.trace.contact) {
        said.trace.contact.axis = changed.outline.axes.findIndex((axis) => axis.name === changed.outline.contact.axis);
        said.trace.contact.set_point = changed.outline.contact.force;
      }
      changed.rows = rows;
      changed.learned = { policy: said.policy, summary: JSON.parse(said.summary), trace: said.trace, text: changed.text };
      changed.seconds = said.after / 1000;
      changed.first = first === null ? null : first / 1000;
      const { summary } = changed.learned;
      const cost = number(summary.final.total);
      say(`Learned again in ${number(changed.seconds)} s: ${summary.rollouts} motions, cost ${cost}${summary.failure ? `; ${summary.failure}` : ""}`);
      $("save-policy").hidden = false;
      showAll();
    },
  });
}

/** The positions of a motion on the way, as a motion to draw. */
function pathTrace(path, task) {
  const samples = path.length / task.axes.length;
  const time = Float64Array.from({ length: samples }, (_, i) => i / task.rate);
  return { time, axes: task.axes.map((_, a) => ({ position: path.subarray(a * samples, (a + 1) * samples) })) };
}

/** Back to the task of the run. */
function forget() {
  stopLearning();
  if (STATE.touch) STATE.touch.leave();
  STATE.changed = null;
  ["forget", "save-task", "save-policy"].forEach((id) => { $(id).hidden = true; });
  say("");
  fit();
  showAll();
}

/** What changes where `handle` is dragged to `at` in the plane. */
function dragged(handle, at) {
  const task = outline();
  const [first, second] = STATE.planes;
  const pairs = isOverTime() ? [[0, at[1]]] : [[first, at[0]], [second, at[1]]];
  if (handle.kind === "wall") {
    const value = rounded(at[wall().across]);
    return [["contact.position", toml(value)]];
  }
  if (handle.kind === "via") {
    const position = [...task.via[handle.index].position];
    pairs.forEach(([axis, value]) => { position[axis] = rounded(value); });
    return [[`via_point.${handle.index}.position`, array(position)]];
  }
  return pairs.map(([axis, value]) => [`axis.${axis}.${handle.kind}`, toml(rounded(value))]);
}

/** Fields for every number that can be changed: for the keyboard, and for what has no place in the scene. */
function drawFields() {
  const task = outline();
  const place = $("fields");
  // Who types goes on typing in the same field.
  const focused = [...place.querySelectorAll("input")].indexOf(document.activeElement);
  place.replaceChildren();
  const field = (label, value, path, write = toml) => {
    if (value === null || value === undefined) return;
    const input = el("input", {
      type: "number", step: "any", value,
      onchange: () => {
        const wanted = input.valueAsNumber;
        if (!Number.isFinite(wanted) || !change([[path, write(wanted)]])) input.value = value;
        else showAll();
      },
    });
    place.append(el("label", {}, label, input));
  };
  task.axes.forEach((axis, a) => {
    field(`${axis.name}: start [${axis.unit}]`, axis.start, `axis.${a}.start`);
    field(`${axis.name}: goal [${axis.unit}]`, axis.goal, `axis.${a}.goal`);
  });
  task.via.forEach((via, i) => task.axes.forEach((axis, a) => {
    const write = (value) => array(via.position.map((old, b) => (a === b ? value : old)));
    field(`via point ${i + 1}: ${axis.name} [${axis.unit}]`, via.position[a], `via_point.${i}.position`, write);
  }));
  if (task.contact && task.contact.movable) field("wall [m]", task.contact.position, "contact.position");
  if (task.contact) field("force to press with [N]", task.contact.force, "contact.force");
  task.forces.forEach((force, i) => field(`${force.kind} on ${force.axis} [N]`, force.amplitude, `disturbance.${i}.amplitude`));
  for (const [gain, unit] of [["stiffness", "N/m"], ["damping", "N s/m"]]) {
    ["least", "most"].forEach((word, side) => {
      const values = task.axes.map((axis) => axis[gain][side]);
      const key = side ? "max" : "min";
      // One number for all axes stays one number.
      if (new Set(values).size === 1) field(`${word} ${gain} [${unit}]`, values[0], `${gain}.${key}`);
      else task.axes.forEach((axis, a) => field(`${word} ${gain} of ${axis.name} [${unit}]`, values[a], `${gain}.${key}`, (value) => array(values.map((old, b) => (a === b ? value : old)))));
    });
  }
  if (focused >= 0) place.querySelectorAll("input")[focused]?.focus();
}
