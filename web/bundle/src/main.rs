//! Makes what a page holds of hpf-web: `bundle PROGRAM.wasm FOLDER` writes `core.js`, the glue, and `core.wasm.gz`.

use std::error::Error;
use std::ffi::OsString;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use flate2::{Compression, GzBuilder};
use wasm_bindgen_cli_support::Bindgen;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    let [program, folder] = arguments.as_slice() else { return Err("usage: bundle PROGRAM.wasm FOLDER".into()) };
    let folder = Path::new(folder);
    fs::create_dir_all(folder)?;
    let mut bindgen = Bindgen::new();
    // A page that opens from disk loads no modules.
    bindgen.input_path(program).no_modules(true)?.typescript(false).remove_producers_section(true);
    let mut made = bindgen.generate_output()?;
    fs::write(folder.join("core.js"), made.js())?;
    let program = made.wasm_mut().emit_wasm();
    // No time stamp: the same program gives the same bytes.
    let mut compressed = GzBuilder::new().mtime(0).write(Vec::new(), Compression::best());
    compressed.write_all(&program)?;
    let compressed = compressed.finish()?;
    println!("core.wasm {} bytes, compressed {} bytes", program.len(), compressed.len());
    fs::write(folder.join("core.wasm.gz"), compressed)?;
    Ok(())
}
