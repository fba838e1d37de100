//! What a controller takes in memory, with its lists in RAM and in flash.

use hpf_core::HybridPrimitive;
use hpf_core::controller::{Controller, Input, Output, Settings};

/// One row, in bytes: a skill with its lists in place, then all the rest with the lists by reference.
macro_rules! row {
    ($float:ident, $axes:literal) => {{
        let skill = size_of::<HybridPrimitive<$float, &[$float; 20], $axes>>();
        let controller = size_of::<Controller<$float, &[$float; 20], $axes>>();
        let settings = size_of::<Settings<$float, $axes>>();
        let state = controller - skill - settings;
        let (input, output) = (size_of::<Input<$float, $axes>>(), size_of::<Output<$float, $axes>>());
        let in_place = size_of::<HybridPrimitive<$float, [$float; 20], $axes>>();
        let name = stringify!($float);
        println!(
            "| {name}, {} | {in_place} | {skill} | {settings} | {state} | {controller} | {input} | {output} |",
            $axes
        );
    }};
}

fn main() {
    println!(
        "| scalar, axes | skill, lists in place | by reference | settings | state | controller | input | output |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    row!(f32, 2);
    row!(f32, 6);
    row!(f64, 2);
    row!(f64, 6);
}
