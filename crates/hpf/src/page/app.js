// What brings the parts together: the time, the pointer, the keys, the controls.

const duration = () => {
  const trace = shownTrace();
  return trace && trace.time.length ? trace.time[trace.time.length - 1] : outline().duration;
};

function setTime(time, moveCursor = true) {
  STATE.time = Math.min(Math.max(0, time), duration());
  $("time").value = STATE.time;
  $("time-label").textContent = `${STATE.time.toFixed(2)} s`;
  if (moveCursor) placeCursor(STATE.time);
  SCENE.isDirty = true;
  requestFrame();
}

function setPlaying(isPlaying) {
  STATE.playing = isPlaying;
  $("play").textContent = isPlaying ? "Pause" : "Play";
  $("play").setAttribute("aria-pressed", String(isPlaying));
  if (isPlaying) {
    if (STATE.touch) STATE.touch.leave();
    if (STATE.time >= duration()) STATE.time = 0;
    requestFrame();
  }
}

/** Pictures of the last second, and their rate; 0 before there is one. */
const FRAMES = { stamps: [], rate: 0, asked: false, last: null };

function requestFrame() {
  if (FRAMES.asked) return;
  FRAMES.asked = true;
  requestAnimationFrame(frame);
}

function frame(stamp) {
  FRAMES.asked = false;
  FRAMES.stamps.push(stamp);
  while (FRAMES.stamps[0] < stamp - 1000) FRAMES.stamps.shift();
  FRAMES.rate = FRAMES.stamps.length;
  if (STATE.touch) {
    STATE.touch.step(stamp);
    STATE.touch.show();
    SCENE.isDirty = true;
  } else if (STATE.playing) {
    const passed = FRAMES.last === null ? 0 : Math.min(0.1, (stamp - FRAMES.last) / 1000);
    setTime(STATE.time + passed * STATE.speed);
    if (STATE.time >= duration()) setPlaying(false);
  }
  FRAMES.last = STATE.touch || STATE.playing ? stamp : null;
  if (SCENE.isDirty) drawScene();
  SCENE.isDirty = false;
  if (STATE.touch || STATE.playing) requestFrame();
}

/** Draws everything again. */
function showAll() {
  $("time").max = duration();
  drawResults();
  drawReproduce();
  drawFields();
  drawCharts();
  drawLearning();
  placeCursor(STATE.time);
  drawScene();
}

/** Where the pointer is on the canvas [px]. */
const pointer = (event) => {
  const box = $("scene").getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
};

/** What is under a point of the canvas: the tool, a handle, the wall. */
function under(point, reach) {
  const near = (at) => Math.hypot(at[0] - point[0], at[1] - point[1]) < reach;
  const now = toolNow();
  if (now && STATE.touch && near(toScreen(...placeOf(now.position, now.time)))) return { kind: "tool" };
  const handle = handles().find((one) => near(toScreen(...one.at)));
  if (handle && !STATE.touch) return handle;
  if (now && near(toScreen(...placeOf(now.position, now.time)))) return { kind: "tool" };
  if (handle) return handle;
  const blocked = wall();
  if (!blocked) return null;
  const edge = toScreen(blocked.at, blocked.at)[blocked.across];
  return Math.abs(edge - point[blocked.across]) < reach ? { kind: "wall" } : null;
}

function setUpPointer() {
  const canvas = $("scene");
  let drag = null;
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button > 0) return;
    const point = pointer(event);
    if (STATE.touch && $("ask-goal").getAttribute("aria-pressed") === "true") {
      newGoal(toPlane(...point));
      return;
    }
    const found = under(point, event.pointerType === "touch" ? 30 : 18) || (STATE.touch ? { kind: "tool" } : null);
    if (!found) return;
    canvas.setPointerCapture(event.pointerId);
    if (found.kind === "tool" && !STATE.touch && !beginTouch()) return;
    drag = { ...found, from: point };
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    const point = pointer(event);
    if (!drag) {
      const found = under(point, 18);
      canvas.style.cursor = found ? "grab" : "default";
      SCENE.hot = found;
      return;
    }
    if (drag.kind === "tool") {
      if (STATE.touch) STATE.touch.pullBy([(point[0] - drag.from[0]) / PIXELS_PER_NEWTON, (drag.from[1] - point[1]) / PIXELS_PER_NEWTON]);
      return;
    }
    change(dragged(drag, toPlane(...point)));
  });
  const end = () => {
    if (drag && drag.kind === "tool" && STATE.touch) STATE.touch.pull.fill(0);
    else if (drag) drawFields();
    drag = null;
  };
  canvas.addEventListener("pointerup", end);
  canvas.addEventListener("pointercancel", end);
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

function setUpKeys() {
  const canvas = $("scene");
  const pushed = new Set();
  const push = () => {
    const size = Number($("push").value) || 0;
    const sum = [0, 0];
    pushed.forEach((key) => ARROWS[key].forEach((part, direction) => { sum[direction] += size * part; }));
    if (STATE.touch) STATE.touch.pullBy(sum);
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.key === " ") setPlaying(!STATE.playing);
    else if (event.key in ARROWS) {
      if (!STATE.touch && !beginTouch()) return;
      pushed.add(event.key);
      push();
    } else return;
    event.preventDefault();
  });
  const release = (event) => {
    if (event.key) pushed.delete(event.key);
    else pushed.clear();
    push();
  };
  canvas.addEventListener("keyup", release);
  canvas.addEventListener("blur", release);
}

/** Shows the run that is chosen. */
function chooseRun(i) {
  if (STATE.touch) STATE.touch.leave();
  stopLearning();
  const { axes } = RUNS[i].outline;
  const second = axes.findIndex((axis, a) => a > 0 && axis.unit === axes[0].unit);
  Object.assign(STATE, { run: i, snapshot: -1, changed: null, planes: [0, second < 0 ? Math.min(1, axes.length - 1) : second], time: 0 });
  ["forget", "save-task", "save-policy"].forEach((id) => { $(id).hidden = true; });
  const option = (value, label) => el("option", { value }, label);
  $("axis").replaceChildren(option("all", "all axes"), ...axes.map((axis, a) => option(a, axis.name)));
  ["plane-0", "plane-1"].forEach((id, direction) => {
    $(id).replaceChildren(...axes.map((axis, a) => option(a, axis.name)));
    $(id).value = STATE.planes[direction];
    $(id).parentElement.hidden = axes.length < 3;
  });
  const slider = $("snapshot");
  slider.max = RUNS[i].snapshots.length;
  slider.value = slider.max;
  slider.parentElement.hidden = !RUNS[i].snapshots.length;
  nameSnapshot();
  fit();
  showAll();
}

function nameSnapshot() {
  const one = run().snapshots[STATE.snapshot];
  $("snapshot-label").textContent = one ? `after update ${one.update}` : "as learned";
}

function setUpControls() {
  $("play").addEventListener("click", () => setPlaying(!STATE.playing));
  $("time").addEventListener("input", () => {
    setPlaying(false);
    setTime(Number($("time").value));
  });
  $("speed").addEventListener("change", () => { STATE.speed = Number($("speed").value); });
  $("axis").addEventListener("change", drawCharts);
  $("zoom-all").addEventListener("click", () => {
    zoomed = null;
    drawCharts();
  });
  $("snapshot").addEventListener("input", () => {
    const i = Number($("snapshot").value);
    STATE.snapshot = i < run().snapshots.length ? i : -1;
    nameSnapshot();
    drawCharts();
    drawScene();
  });
  ["plane-0", "plane-1"].forEach((id, direction) => $(id).addEventListener("change", () => {
    STATE.planes[direction] = Number($(id).value);
    fit();
    drawScene();
  }));
  const chooser = $("run");
  chooser.replaceChildren(...RUNS.map((one, i) => el("option", { value: i }, one.name)));
  chooser.parentElement.hidden = RUNS.length < 2;
  chooser.addEventListener("change", () => chooseRun(Number(chooser.value)));
  $("learn").addEventListener("click", () => change([]));
  $("forget").addEventListener("click", forget);
  $("save-task").addEventListener("click", () => save(`${outline().name}.toml`, STATE.changed.text, "application/toml"));
  $("save-policy").addEventListener("click", () => save("policy.json", policyText(), "application/json"));
  $("print").addEventListener("click", () => window.print());
  $("theme").addEventListener("click", () => {
    const isDark = getComputedStyle(document.documentElement).colorScheme.includes("dark");
    document.documentElement.dataset.theme = isDark ? "light" : "dark";
    showAll();
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", showAll);
  let wait = null;
  window.addEventListener("resize", () => {
    clearTimeout(wait);
    wait = setTimeout(() => {
      resizeScene();
      showAll();
    }, 120);
  });
  window.addEventListener("beforeprint", () => {
    document.documentElement.dataset.printed = "";
    resizeScene();
    showAll();
  });
  window.addEventListener("afterprint", () => {
    delete document.documentElement.dataset.printed;
    resizeScene();
    showAll();
  });
}

document.body.classList.toggle("many", RUNS.length > 1);
setUpControls();
setUpPointer();
setUpKeys();
setUpTouch();
resizeScene();
chooseRun(0);
const booted = new Promise((resolve) => { setTimeout(resolve, 0); }).then(bootEngine).then(() => {
  ["learn", "touch"].forEach((id) => { $(id).disabled = false; });
}).catch((error) => {
  ENGINE.failure = error;
  say(`Touching and learning need WebAssembly, which did not start: ${error.message}`, true);
});

// For programs that drive the page.
window.hpf = { STATE, RUNS, ENGINE, FRAMES, booted, change, beginTouch, policyText, toScreen, handles, readTask, setTime, chooseRun };
