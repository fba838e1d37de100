// The core of HPF in the page: compiled from the crates that the program is made of. It learns in a worker.

const ENGINE = { module: null, failure: null, worker: null, waiting: null, busy: false };

/** What runs in the worker, behind the glue of the core. */
const WORKER = `
onmessage = ({ data }) => {
  if (data.module) {
    wasm_bindgen.initSync({ module: data.module });
    postMessage({ kind: "ready" });
    return;
  }
  try {
    const task = new wasm_bindgen.WebTask(data.text, data.tables);
    const begun = performance.now();
    const learned = wasm_bindgen.learn(task, (update, rollouts, total, path) =>
      postMessage({ kind: "progress", update, rollouts, total, path, after: performance.now() - begun }));
    const motion = learned.trace();
    const names = ${JSON.stringify(SIGNALS)};
    const axes = JSON.parse(task.describe()).axes.map((_, a) => Object.fromEntries(names.map((name) => [name, motion.axis(a, name)])));
    const contact = Object.fromEntries(${JSON.stringify(CONTACT)}.map((name) => [name, motion.contact(name)]));
    const trace = { time: motion.time(), rest: motion.restSteps(), axes, contact: contact.force.length ? contact : null };
    postMessage({ kind: "done", policy: learned.policy(), summary: learned.summary(), trace, after: performance.now() - begun });
  } catch (error) {
    postMessage({ kind: "failed", message: String(error.message || error) });
  }
};
`;

/** Unpacks and compiles the core, once. */
async function bootEngine() {
  const packed = Uint8Array.from(atob($("core-wasm").textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  const bytes = await new Response(stream).arrayBuffer();
  ENGINE.module = await WebAssembly.compile(bytes);
  wasm_bindgen.initSync({ module: ENGINE.module });
  startWorker();
}

function startWorker() {
  const glue = $("core-glue").textContent;
  const address = URL.createObjectURL(new Blob([glue, WORKER], { type: "text/javascript" }));
  const worker = new Worker(address);
  worker.onmessage = ({ data }) => {
    if (data.kind === "ready") URL.revokeObjectURL(address);
    else ENGINE.heard(data);
  };
  worker.onerror = (event) => ENGINE.heard({ kind: "failed", message: event.message || "the worker failed" });
  worker.postMessage({ module: ENGINE.module });
  ENGINE.worker = worker;
}

/** Learns the task `text`; of several asked for while one is learned, the last one follows. */
function learnNext(job) {
  ENGINE.waiting = job;
  if (!ENGINE.busy) nextJob();
}

function nextJob() {
  const job = ENGINE.waiting;
  ENGINE.waiting = null;
  if (!job) return;
  ENGINE.busy = true;
  ENGINE.heard = (said) => {
    if (said.kind !== "progress") ENGINE.busy = false;
    job.heard(said);
    if (said.kind !== "progress") nextJob();
  };
  ENGINE.worker.postMessage({ text: job.text, tables: job.tables });
}

/** Ends what is being learned. */
function stopLearning() {
  ENGINE.waiting = null;
  if (!ENGINE.busy) return;
  ENGINE.worker.terminate();
  ENGINE.busy = false;
  startWorker();
}

/** The task of a run, read by the core. */
function readTask(text, tables) {
  if (!ENGINE.module) throw new Error("the core is still being unpacked");
  return new wasm_bindgen.WebTask(text, JSON.stringify(tables));
}
