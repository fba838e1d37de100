//! Runs the module that is its argument in a sandbox and compares every result with the host's.

use std::process::ExitCode;

use hpf_wasm_proof::{COUNT, result};
use wasmi::{Engine, Linker, Module, Store};

fn main() -> ExitCode {
    let path = std::env::args().nth(1).expect("name the module");
    let bytes = std::fs::read(&path).expect("the module can be read");
    let engine = Engine::default();
    let module = Module::new(&engine, &bytes[..]).expect("the module is valid");
    let mut store = Store::new(&engine, ());
    // It asks for nothing: no clock, no file, no randomness, no thread.
    let imports = module.imports().count();
    let instance = Linker::new(&engine).instantiate_and_start(&mut store, &module).expect("the module needs no import");
    let there = instance.get_typed_func::<u32, u64>(&store, "hpf_result").expect("the module has its results");
    let mut differ = 0;
    for index in 0..COUNT {
        let found = there.call(&mut store, index as u32).expect("no result traps");
        let expected = result(index);
        let is_same = found == expected;
        println!("  {index}: {found:016x} {}", if is_same { "as on the host" } else { "DIFFERS from the host" });
        differ += usize::from(!is_same);
    }
    println!("{imports} imports, {differ} of {COUNT} results differ");
    if differ == 0 && imports == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
