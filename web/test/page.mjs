// Pages in headless Chromium: opened from disk, played, dragged, pushed, printed, looked at. `node --test page.mjs` with
// HPF_PROGRAM and CHROMIUM; pictures go to HPF_PICTURES, where it is set.
import { execFileSync } from "node:child_process";
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import assert from "node:assert/strict";
import { pathToFileURL } from "node:url";
import { root } from "./support.mjs";

const { default: puppeteer } = await import(process.env.HPF_PUPPETEER || "puppeteer-core");
const folder = mkdtempSync(join(tmpdir(), "hpf-page-"));
const pictures = process.env.HPF_PICTURES;
if (pictures) mkdirSync(pictures, { recursive: true });
let browser;

before(async () => {
  browser = await puppeteer.launch({
    executablePath: process.env.CHROMIUM || "/usr/bin/chromium",
    args: ["--no-sandbox", "--disable-gpu", "--hide-scrollbars"],
  });
});
after(async () => {
  await browser.close();
  rmSync(folder, { recursive: true, force: true });
});

/** Runs the program; a target that was missed is no failure. */
function hpf(...words) {
  try {
    return execFileSync(process.env.HPF_PROGRAM, words, { cwd: folder, encoding: "utf8", stdio: "pipe" });
  } catch (error) {
    if (error.status === 3) return error.stdout;
    throw new Error(`${words.join(" ")}: ${error.stderr}`);
  }
}
const task = (name) => join(root, "tasks", `${name}.toml`);

/** Opens a page of the folder; what it complains of, and what it asks the network for, is kept. */
async function open(file, { width = 1280, height = 800, scheme = "light" } = {}) {
  const page = await browser.newPage();
  const complaints = [];
  page.on("console", (message) => ["error", "warn"].includes(message.type()) && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file|blob|data):/.test(request.url())) complaints.push(`asked for ${request.url()}`);
  });
  await page.setViewport({ width, height, deviceScaleFactor: 1 });
  await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
  await page.goto(pathToFileURL(join(folder, file)).href);
  await page.evaluate(() => window.hpf.booted);
  return { page, complaints };
}
const picture = async (page, name) => pictures && page.screenshot({ path: join(pictures, `${name}.png`) });
const settle = (page, time) => page.evaluate((ms) => new Promise((resolve) => { setTimeout(resolve, ms); }), time);

/** Where a point of the scene is in the window. */
const inWindow = (page, place) => page.evaluate(([x, y]) => {
  const box = document.getElementById("scene").getBoundingClientRect();
  const at = window.hpf.toScreen(x, y);
  return [box.left + at[0], box.top + at[1]];
}, place);

test("a run opens from disk at once, is small, and complains of nothing", async () => {
  hpf("learn", task("via_point"), "--set", "learning.updates=120", "--set", "output.snapshots=[0,60,120]", "--out", "run", "--quiet", "--report");
  const size = statSync(join(folder, "run/report.html")).size;
  assert.ok(size < 3e6, `${size} bytes`);
  const { page, complaints } = await open("run/report.html");
  const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
  console.log(`report: ${size} bytes, first paint after ${paint.toFixed(0)} ms`);
  assert.ok((await page.$$(".chart")).length >= 5);
  await picture(page, "light");
  await page.click("#play");
  await settle(page, 1000);
  const time = await page.evaluate(() => window.hpf.STATE.time);
  assert.ok(time > 0.3, `after a second of playing the time is ${time}`);
  await page.click("#play");
  await page.$eval("#snapshot", (slider) => { slider.value = 0; slider.dispatchEvent(new Event("input")); });
  assert.match(await page.$eval("#snapshot-label", (label) => label.textContent), /after update 0/);
  const pdf = Buffer.from(await page.pdf({ format: "A4" })).toString("latin1");
  const sheets = pdf.match(/\/Type\s*\/Page\b/g).length;
  assert.ok(sheets <= 2, `${sheets} sheets of paper`);
  if (pictures) writeFileSync(join(pictures, "page.pdf"), pdf, "latin1");
  assert.deepEqual(complaints, []);
  await page.close();
});

test("a via point that is dragged is learned again, and the program learns the same bytes of the saved task", async () => {
  const { page, complaints } = await open("run/report.html", { scheme: "dark" });
  await picture(page, "dark");
  const via = await page.evaluate(() => window.hpf.handles().find((handle) => handle.kind === "via").at);
  const from = await inWindow(page, via);
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(from[0] + 30, from[1] - 15, { steps: 5 });
  await page.mouse.move(from[0] + 60, from[1] - 25, { steps: 5 });
  await page.mouse.up();
  await page.waitForFunction(() => window.hpf.STATE.changed?.learned?.text === window.hpf.STATE.changed?.text && !window.hpf.ENGINE.busy, { timeout: 240000 });
  const found = await page.evaluate(() => {
    const { changed } = window.hpf.STATE;
    return { text: changed.text, policy: window.hpf.policyText(), seconds: changed.seconds, first: changed.first, outline: changed.outline };
  });
  console.log(`learned again in ${found.seconds.toFixed(2)} s, a better path after ${found.first?.toFixed(2)} s`);
  assert.notDeepEqual(found.outline.via[0].position, via);
  writeFileSync(join(folder, "moved.toml"), found.text);
  hpf("learn", "moved.toml", "--out", "moved", "--quiet");
  assert.equal(found.policy, readFileSync(join(folder, "moved/policy.json"), "utf8"));
  await picture(page, "dark-moved");
  await page.click("#forget");
  assert.equal(await page.evaluate(() => window.hpf.STATE.changed), null);
  assert.deepEqual(complaints, []);
  await page.close();
});

test("the tool gives way by f/k under the mouse, holds, goes on, stops and starts again", async () => {
  const { page, complaints } = await open("run/report.html");
  await page.click("#touch");
  const state = () => page.evaluate(() => window.hpf.STATE.touch.now());
  const mode = () => page.$eval("#mode", (label) => label.textContent);
  await settle(page, 300);
  await page.click("#ask-hold");
  await settle(page, 600);
  assert.equal(await mode(), "Hold");
  await page.click("#ask-resume");
  // The forces of the task end with the movement.
  await page.waitForFunction(() => window.hpf.STATE.touch.state[0] > 6.5, { timeout: 30000 });
  const tool = await inWindow(page, (await state()).position);
  await page.mouse.move(...tool);
  await page.mouse.down();
  await page.mouse.move(tool[0] - 40, tool[1] + 20, { steps: 4 });
  await settle(page, 4000);
  const now = await state();
  await picture(page, "touch");
  [-10, -5].forEach((force, a) => {
    // The window rounds where the mouse is.
    assert.ok(Math.abs(now.force[a] - force) < 1e-3, `axis ${a}: ${now.force[a]} N`);
    const expected = force / now.stiffness[a];
    assert.ok(Math.abs(now.offset[a] - expected) < 2e-3 * Math.abs(expected), `axis ${a}: ${now.offset[a]} for ${expected}`);
  });
  await page.mouse.up();
  await settle(page, 3000);
  const free = await state();
  assert.ok(free.offset.every((offset) => Math.abs(offset) < 1e-3), String(free.offset));
  await page.click("#ask-stop");
  await settle(page, 500);
  assert.equal(await mode(), "Stop");
  await page.click("#ask-reset");
  await settle(page, 200);
  assert.equal(await mode(), "Idle");
  await page.click("#ask-start");
  await settle(page, 300);
  assert.equal(await mode(), "Run");
  // The keyboard pushes too.
  await page.focus("#scene");
  await page.keyboard.down("ArrowRight");
  await settle(page, 200);
  assert.equal((await page.evaluate(() => window.hpf.STATE.touch.pull[0])), 10);
  await page.keyboard.up("ArrowRight");
  await page.$eval("#set-force", (field) => { field.value = 3; field.dispatchEvent(new Event("change")); });
  await page.keyboard.down("ArrowUp");
  await settle(page, 300);
  assert.ok((await state()).force.every((force) => Math.abs(force) <= 3));
  assert.match(await page.$eval("#readout", (readout) => readout.textContent), /limits hit: force/);
  await page.keyboard.up("ArrowUp");
  assert.deepEqual(complaints, []);
  await page.close();
});

test("six axes are stepped at 1 kHz and drawn while they are pushed", async () => {
  const axes = [..."xyzabc"].map((name, i) => `[[axis]]\nname = "${name}"\n${i > 2 ? 'unit = "rad"\n' : ""}start = 0.0\ngoal = ${0.1 * (i + 1)}\n`);
  const text = readFileSync(task("reach"), "utf8").replace(/\[\[axis\]\][^[]*/, `${axes.join("\n")}\n`);
  writeFileSync(join(folder, "six.toml"), text);
  hpf("learn", "six.toml", "--set", "learning.updates=20", "--out", "six", "--quiet", "--report");
  const { page, complaints } = await open("six/report.html");
  await page.focus("#scene");
  await page.keyboard.down("ArrowRight");
  await settle(page, 1200);
  const begin = await page.evaluate(() => ({ at: performance.now(), time: window.hpf.STATE.touch.state[0] }));
  await settle(page, 3000);
  const end = await page.evaluate(() => ({ at: performance.now(), time: window.hpf.STATE.touch.state[0], rate: window.hpf.FRAMES.rate }));
  const share = (end.time - begin.time) / ((end.at - begin.at) / 1000);
  console.log(`six axes pushed: ${end.rate} pictures a second, ${(1000 * share).toFixed(0)} steps of 1 ms a second`);
  assert.ok(end.rate >= 10, `${end.rate} pictures a second`);
  await page.keyboard.up("ArrowRight");
  await picture(page, "six");
  assert.deepEqual(complaints, []);
  await page.close();
});

test("several runs stand side by side, tasks without a run can be learned, small screens hold all", async () => {
  hpf("learn", task("via_point"), "--set", "via_point.0.position=[0.5,0.9]", "--set", "learning.updates=60", "--out", "higher", "--quiet");
  hpf("report", "run", "higher", "--out", "both.html");
  const both = await open("both.html");
  assert.equal((await both.page.$$(".card")).length, 2);
  await both.page.select("#run", "1");
  await picture(both.page, "both");
  await both.page.close();
  hpf("report", ...["reach", "wall", "cantilever"].map(task), "--out", "playground/index.html");
  const { page, complaints } = await open("playground/index.html", { width: 390, height: 844 });
  await page.select("#run", "1");
  await page.click("#learn");
  await page.waitForFunction(() => window.hpf.STATE.changed?.learned && !window.hpf.ENGINE.busy, { timeout: 240000 });
  const wide = await page.evaluate(() => document.documentElement.scrollWidth);
  assert.ok(wide <= 390, `${wide} px wide on a screen of 390 px`);
  await picture(page, "small");
  await page.select("#run", "2");
  await page.click("#learn");
  await page.waitForFunction(() => window.hpf.STATE.changed?.learned && !window.hpf.ENGINE.busy, { timeout: 240000 });
  await page.click("#touch");
  assert.match(await page.$eval("#message", (message) => message.textContent), /cannot hold a contact this stiff/);
  assert.deepEqual([...both.complaints, ...complaints], []);
  await page.close();
});

test("a hostile run breaks nothing and runs nothing", async () => {
  const name = "<img src=x onerror=window.bad=1>";
  cpSync(join(folder, "run"), join(folder, name), { recursive: true });
  const edit = (file, change) => {
    const place = join(folder, name, file);
    writeFileSync(place, change(readFileSync(place, "utf8")));
  };
  edit("task.toml", (text) => `# </script><script>window.bad = 1</script> <!-- \u2028\n${text}`);
  edit("summary.json", (text) => {
    const summary = JSON.parse(text);
    summary.stopped_because = "</script><script>window.bad = 1</script>";
    summary.metrics[0].name = "<b onmouseover=window.bad=1>x</b>";
    summary.metrics[0].value = 1e308;
    summary.metrics[1].value = null;
    return JSON.stringify(summary);
  });
  edit("trajectory.csv", (text) => text.split("\n").map((row, i) => {
    const cells = row.split(",");
    if (i > 40 && i < 60 && cells.length > 5) cells[4] = "NaN";
    if (i === 80) cells[5] = "1e308";
    if (i === 81) cells[4] = "-inf";
    return cells.join(",");
  }).join("\n"));
  edit("learning.csv", (text) => text.split("\n").map((row, i) => (i === 3 ? row.replace(/^(\d+,\d+),[^,]+/, "$1,NaN") : row)).join("\n"));
  hpf("report", name, "--out", "hostile.html");
  const { page, complaints } = await open("hostile.html");
  await page.click("#play");
  await settle(page, 500);
  await page.click("#play");
  await picture(page, "hostile");
  await page.click("#touch");
  await settle(page, 300);
  assert.equal(await page.evaluate(() => window.bad), undefined);
  assert.equal((await page.$$("#results img, #results b, h1 img, h1 script")).length, 0);
  assert.deepEqual(complaints, []);
  await page.close();
});
