// The core of pages against the program: what both learn of the shipped tasks has the same bytes, and the keys of a task
// are the same. `node core.mjs PROGRAM [TASK...]`
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";
import assert from "node:assert/strict";
import { core, root } from "./support.mjs";

const program = process.env.HPF_PROGRAM;
const folder = mkdtempSync(join(tmpdir(), "hpf-web-"));
process.on("exit", () => rmSync(folder, { recursive: true, force: true }));

/** The text of a shipped task; of 600 updates of PI2 the first 40, unless HPF_WEB_ALL asks for all. */
function textOf(name) {
  const text = readFileSync(join(root, "tasks", `${name}.toml`), "utf8");
  return process.env.HPF_WEB_ALL ? text : text.replace(/^updates = [0-9]+/m, "updates = 40").replace(/^snapshots = .*/m, "snapshots = []");
}

/** What the program learns of a task, and what it leaves in its run. */
function learnedByProgram(name) {
  const place = join(folder, name);
  if (existsSync(place)) return { policy: readFileSync(join(place, "policy.json"), "utf8"), place };
  writeFileSync(join(folder, `${name}.toml`), textOf(name));
  run("learn", join(folder, `${name}.toml`), "--out", place, "--quiet");
  return { policy: readFileSync(join(place, "policy.json"), "utf8"), place };
}

/** Runs the program; a target that was missed is no failure. */
function run(...words) {
  try {
    return execFileSync(program, words, { encoding: "utf8", stdio: "pipe" });
  } catch (error) {
    if (error.status !== 3) throw new Error(`hpf ${words.join(" ")}: ${error.stderr}`);
    return error.stdout;
  }
}

const web = core();
const all = readdirSync(join(root, "tasks")).filter((file) => file.endsWith(".toml")).map((file) => file.slice(0, -5));
// A motion of the stochastic task is many; HPF_WEB_ALL has the time for it.
for (const name of all.filter((one) => process.env.HPF_WEB_ALL || one !== "via_point_stochastic")) {
  test(`${name}: the core learns the policy of the program, byte for byte`, () => {
    const { policy } = learnedByProgram(name);
    const begun = performance.now();
    const learned = web.learn(new web.WebTask(textOf(name), "{}"), () => {});
    console.log(`${name}: learned in ${((performance.now() - begun) / 1000).toFixed(2)} s`);
    assert.equal(learned.policy(), policy);
  });
}

test("a task moved in the page gives the same policy in the program", () => {
  const text = readFileSync(join(root, "tasks/via_point.toml"), "utf8");
  const moved = new web.WebTask(text, "{}").with("learning.method", '"auto"').with("via_point.0.position", "[0.5, 0.9]");
  const place = join(folder, "moved");
  const changes = ["--set", 'learning.method="auto"', "--set", "via_point.0.position=[0.5, 0.9]"];
  run("learn", join(root, "tasks/via_point.toml"), ...changes, "--out", place, "--quiet");
  const saved = readFileSync(join(place, "task.toml"), "utf8");
  // Weights, not the hash of the text: the program may write a changed line with other spaces.
  const weights = (policy) => JSON.parse(policy).axes;
  const learned = web.learn(moved, () => {}).policy();
  assert.deepEqual(weights(learned), weights(readFileSync(join(place, "policy.json"), "utf8")));
  const again = web.learn(new web.WebTask(saved, "{}"), () => {}).policy();
  assert.equal(again, readFileSync(join(place, "policy.json"), "utf8"));
});

test("the keys of a task and of the controller's settings are those of the program", () => {
  const schema = execFileSync(program, ["schema"], { encoding: "utf8" });
  // The program gives the whole a title of its own.
  assert.deepEqual({ ...JSON.parse(web.schema()), title: "HPF task file" }, JSON.parse(schema));
});

test("without a pull the skill moves as the program's controller moves it", () => {
  const { policy, place } = learnedByProgram("reach");
  const out = join(folder, "controlled");
  run("run", place, "--controller", "--rate", "1000", "--out", out, "--quiet");
  const rows = readFileSync(join(out, "trajectory.csv"), "utf8").trim().split("\n").map((row) => row.split(","));
  const at = rows[0].findIndex((name) => name === `${JSON.parse(policy).axes[0].name}_position_m`);
  assert.ok(at > 0, rows[0].join());
  const touch = new web.WebTouch(new web.WebTask(readFileSync(join(root, "tasks/reach.toml"), "utf8"), "{}"), policy, "");
  touch.ask("start");
  for (let i = 1; i < rows.length - 1; i += 1) {
    touch.advance(1);
    assert.equal(touch.state()[6], Number(rows[i + 1][at]), `step ${i}`);
  }
});

test("under a steady pull the tool settles at f/k, and lets go without it", () => {
  const { policy } = learnedByProgram("reach");
  // Without the task's own forces.
  const text = readFileSync(join(root, "tasks/reach.toml"), "utf8").replace(/\[\[disturbance\]\][^[]*/g, "");
  const touch = new web.WebTouch(new web.WebTask(text, "{}"), policy, "");
  touch.ask("start");
  touch.advance(10000);
  touch.pull(Float64Array.of(7));
  touch.advance(20000);
  const [, , , stiffness, , offset] = touch.state().slice(6);
  assert.ok(Math.abs(offset - 7 / stiffness) < 1e-9 * offset, `${offset} for ${7 / stiffness}`);
  touch.pull(Float64Array.of(0));
  touch.advance(20000);
  assert.ok(Math.abs(touch.state()[11]) < 1e-9);
});

test("mistakes in a task are named with line and column", () => {
  assert.throws(() => new web.WebTask("name = 3\n", "{}"), /line 1, column 1: the task has no `duration`/);
  assert.throws(() => new web.WebTask(readFileSync(join(root, "examples/process/point_mass.toml"), "utf8"), "{}"), /process/);
  const table = readFileSync(join(root, "tasks/reach.toml"), "utf8").replace(/\[\[disturbance\]\][^[]*/, '[[disturbance]]\nkind = "table"\naxis = "x"\nfile = "<b>.csv"\n\n');
  assert.throws(() => new web.WebTask(table, "{}"), /force table|no axis/);
});
