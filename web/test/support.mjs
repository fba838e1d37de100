// What the tests share: where things are, and the core of pages in node.
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { gunzipSync } from "node:zlib";

export const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const made = join(root, "crates/hpf/src/page/core");

/** The core that is in every page. */
export function core() {
  const glue = readFileSync(join(made, "core.js"), "utf8");
  const bindings = new Function(`${glue}\nreturn wasm_bindgen;`)();
  bindings.initSync({ module: new WebAssembly.Module(gunzipSync(readFileSync(join(made, "core.wasm.gz")))) });
  return bindings;
}
