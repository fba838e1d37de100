// What was learned, in numbers; the task; how to make it again.

/** The result that is shown of a run: that of the task moved by hand, where it was learned. */
function resultOf(one, i) {
  const moved = i === STATE.run && STATE.changed && STATE.changed.learned;
  if (moved) {
    const { summary } = moved;
    return { name: `${one.name}, moved by hand`, cost: [summary.initial, summary.final], metrics: summary.metrics, line: `${summary.rollouts} motions, ${number(STATE.changed.seconds)} s of learning here, method ${summary.method}, seed ${summary.seed}` };
  }
  const { summary } = one;
  if (!summary) return { name: one.name, cost: null, metrics: [], line: "Nothing is learned yet." };
  const cost = [summary.cost.initial, summary.cost.final].map(({ total, ...terms }) => ({ total, terms: DATA.terms.map((term) => terms[term]) }));
  return { name: one.name, cost, metrics: summary.metrics, line: `${summary.updates} updates, ${summary.rollouts_total} motions, ${number(summary.learning_s)} s of learning, method ${summary.method}, seed ${summary.seed}; stopped because ${summary.stopped_because}` };
}

const cell = (text, attributes = {}) => el("td", attributes, text);
const head = (...names) => el("thead", {}, el("tr", {}, ...names.map((name) => el("th", { scope: "col" }, name))));

function costTable([before, after]) {
  const rows = DATA.terms.map((term, i) => [term, before.terms[i], after.terms[i]]).filter(([, a, b]) => a !== 0 || b !== 0);
  const row = ([name, a, b], attributes) => el("tr", attributes, el("th", { scope: "row" }, name), cell(number(a)), cell(number(b)));
  return el("table", { class: "numbers" }, head("cost", "before", "after"), el("tbody", {}, ...rows.map((one) => row(one, {})), row(["total", before.total, after.total], { class: "total" })));
}

/** A measure in the unit that suits its size: millimetres for small lengths. */
function measure(value, unit) {
  if (unit === "m" && Number.isFinite(value) && Math.abs(value) < 0.1) return `${number(1e3 * value)} mm`;
  return unit ? `${number(value)} ${unit}` : number(value);
}

function measureTable(metrics) {
  const verdict = (metric) => (metric.pass === true ? "✓ pass" : metric.pass === false ? "✗ miss" : "");
  const rows = metrics.map((metric) => el("tr", {},
    el("th", { scope: "row" }, metric.name), cell(measure(metric.value, metric.unit)),
    cell(metric.target == null ? "" : `at most ${measure(metric.target, metric.unit)}`),
    cell(verdict(metric), { class: metric.pass === false ? "miss" : "pass" })));
  return el("table", { class: "numbers" }, head("measure", "value", "target", ""), el("tbody", {}, ...rows));
}

function drawResults() {
  const cards = RUNS.map((one, i) => {
    const result = resultOf(one, i);
    const missed = result.metrics.filter((metric) => metric.pass === false).length;
    const judged = result.metrics.filter((metric) => metric.pass != null).length;
    const verdict = judged ? (missed ? `${missed} of ${judged} targets missed` : `all ${judged} targets passed`) : "no targets";
    const total = result.cost ? el("p", { class: "big" }, `cost ${number(result.cost[1].total)}`, el("small", {}, ` from ${number(result.cost[0].total)}; `), el("small", { class: missed ? "miss" : "pass" }, verdict)) : null;
    const tables = result.cost ? [measureTable(result.metrics), costTable(result.cost)] : [];
    return el("article", { class: "card" }, el("h3", {}, result.name), total, el("p", { class: "quiet" }, result.line), ...tables);
  });
  $("results").replaceChildren(...cards);
}

function drawReproduce() {
  const one = run();
  const text = STATE.changed ? STATE.changed.text : one.task;
  $("task-text").textContent = text;
  const lines = [
    ["version", `hpf ${DATA.version}`],
    ["commands", one.commands.join("\n")],
    ["task, SHA-256", one.summary ? one.summary.task_sha256 : null],
    ["policy, SHA-256", one.summary ? one.summary.policy_sha256 : null],
    ["seed", one.summary ? String(one.summary.seed) : null],
    ["this page", DATA.command],
  ].filter(([, value]) => value);
  $("reproduce").replaceChildren(...lines.flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, el("code", {}, value))]));
  $("notes").replaceChildren(...DATA.notes.map((note) => el("li", {}, note)));
}
