// The skill under the hand: the controller of a robot, stepped at 1 kHz between two pictures.

const MODES = ["Idle", "Run", "Hold", "Stop", "Fault"];
const LIMITS = ["force", "offset", "velocity", "acceleration", "position"];
/** Force of the arrow keys [N] where the field says nothing else. */
const MOST_STEPS = 60;

class Touch {
  constructor() {
    const task = STATE.changed ? STATE.changed.task : readTask(run().task, run().tables);
    this.axes = outline().axes;
    this.control = new wasm_bindgen.WebTouch(task, policyText(), settingsText());
    this.pull = this.axes.map(() => 0);
    this.owed = 0;
    this.last = null;
    this.trail = [];
    this.control.ask("start");
    this.control.advance(1);
    this.state = this.control.state();
    const notes = this.control.notes();
    say(notes.length ? notes.join(" ") : "Under your hand: pull the tool, or use the arrow keys.");
  }

  /** Makes the steps that are due at the time `stamp` [ms] of the picture. */
  step(stamp) {
    if (this.last !== null) {
      this.owed += (stamp - this.last) / 1000 / this.control.dt();
      // A page that was hidden does not catch up.
      const steps = Math.min(MOST_STEPS, Math.floor(this.owed));
      this.owed = Math.min(1, this.owed - steps);
      this.advance(steps);
    }
    this.last = stamp;
  }

  /** Makes `steps` steps. */
  advance(steps) {
    this.control.pull(Float64Array.from(this.pull));
    this.control.advance(steps);
    this.state = this.control.state();
    const now = this.now();
    this.trail.push([placeOf(now.position, now.time), now.time]);
    if (this.trail.length > 600) this.trail.shift();
  }

  now() {
    const { state } = this;
    const of = (k) => this.axes.map((_, a) => state[6 + 8 * a + k]);
    const time = Math.min(state[0], outline().duration);
    return { time, position: of(0), reference: of(1), stiffness: of(3), damping: of(4), offset: of(5), force: of(6), hits: of(7) };
  }

  drawTrail(pen) {
    pen.beginPath();
    this.trail.forEach(([place], i) => {
      const [x, y] = toScreen(...place);
      if (i) pen.lineTo(x, y);
      else pen.moveTo(x, y);
    });
    Object.assign(pen, { strokeStyle: colour("series-3"), lineWidth: 2 });
    pen.stroke();
  }

  /** Pulls with `force` [N] in the directions of the plane. */
  pullBy(force) {
    this.pull.fill(0);
    if (isOverTime()) this.pull[0] = force[1];
    else STATE.planes.forEach((axis, direction) => { this.pull[axis] = force[direction]; });
  }

  show() {
    const { state } = this;
    const [time, , rate, energy, mode] = state;
    const now = this.now();
    $("mode").textContent = MODES[mode];
    $("mode").dataset.mode = MODES[mode];
    const hits = LIMITS.filter((_, i) => now.hits.some((bits) => (bits >> i) & 1));
    const rows = this.axes.map((axis, a) => {
      const unit = UNITS[axis.unit];
      const give = now.force[a] / now.stiffness[a];
      return [`${axis.name}: pull ${number(this.pull[a])} ${unit.force}`, `offset ${number(now.offset[a])} ${unit.position}`, `f/k ${number(give)} ${unit.position}`, `k ${number(now.stiffness[a])} ${unit.stiffness}`, `d ${number(now.damping[a])} ${unit.damping}`];
    });
    $("readout").replaceChildren(
      ...rows.map((cells) => el("tr", {}, ...cells.map((cell) => el("td", {}, cell)))),
      el("tr", {}, el("td", { colspan: 5 }, `time ${time.toFixed(2)} s, rate ${rate.toFixed(2)}; limits hit: ${hits.length ? hits.join(", ") : "none"}`)),
    );
    const capacity = Number($("set-tank").value);
    $("tank").hidden = $("tank-label").hidden = !(capacity > 0);
    $("tank").max = capacity || 1;
    $("tank").value = Math.max(0, energy);
    $("tank-label").textContent = `tank ${number(energy)} J`;
  }

  leave() {
    STATE.touch = null;
    $("touch-panel").hidden = true;
    $("touch").setAttribute("aria-pressed", "false");
    this.control.free();
  }
}

/** The settings of the controller from the fields, as the settings file has them. */
function settingsText() {
  const positive = (id) => (Number($(id).value) > 0 ? toml(Number($(id).value)) : null);
  const limits = [["force", "set-force"], ["offset", "set-offset"], ["velocity", "set-velocity"]]
    .map(([key, id]) => [key, positive(id)]).filter(([, value]) => value).map(([key, value]) => `${key} = ${value}`);
  const tank = positive("set-tank");
  return `[limits]\n${limits.join("\n")}\n${tank ? `[tank]\ncapacity = ${tank}\nrefill = 0.5\n` : ""}`;
}

/** Puts the skill under the hand; it starts to move. */
function beginTouch() {
  if (!policyText()) {
    say("Nothing is learned yet: learn first.", true);
    return false;
  }
  try {
    if (STATE.touch) STATE.touch.leave();
    setPlaying(false);
    STATE.touch = new Touch();
  } catch (error) {
    say(`The controller refuses: ${error.message}`, true);
    return false;
  }
  $("touch-panel").hidden = false;
  $("touch").setAttribute("aria-pressed", "true");
  requestFrame();
  return true;
}

function setUpTouch() {
  $("touch").addEventListener("click", () => {
    if (STATE.touch) {
      STATE.touch.leave();
      say("");
      drawScene();
    } else beginTouch();
  });
  for (const request of ["start", "hold", "resume", "stop", "reset"]) {
    $(`ask-${request}`).addEventListener("click", () => {
      if (!STATE.touch) return;
      STATE.touch.trail = request === "start" ? [] : STATE.touch.trail;
      STATE.touch.control.ask(request);
    });
  }
  $("ask-goal").addEventListener("click", () => {
    const isOn = $("ask-goal").getAttribute("aria-pressed") !== "true";
    $("ask-goal").setAttribute("aria-pressed", String(isOn));
    if (isOn) say("Click where the new goal is.");
  });
  for (const id of ["set-force", "set-offset", "set-velocity", "set-tank"]) {
    $(id).addEventListener("change", () => {
      if (!STATE.touch) return;
      try {
        STATE.touch.control.set(settingsText());
        say("The new settings are in use.");
      } catch (error) {
        say(`The controller refuses: ${error.message}`, true);
      }
    });
  }
}

/** A new goal at a place of the plane. */
function newGoal(at) {
  const goal = outline().axes.map((axis) => axis.goal);
  if (isOverTime()) [, goal[0]] = at;
  else STATE.planes.forEach((axis, direction) => { goal[axis] = at[direction]; });
  STATE.touch.control.goal(Float64Array.from(goal));
  $("ask-goal").setAttribute("aria-pressed", "false");
  say(`Asked for the goal ${goal.map(number).join(", ")}.`);
}
