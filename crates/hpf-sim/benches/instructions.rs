//! What `scripts/instructions.sh` counts: so many batches of 8 rollouts, or so many updates of PI2 from one, on one
//! thread, without measuring anything itself.
//!
//! Arguments: task (cantilever, via_point), part (rollouts, update), times.

#[allow(dead_code, reason = "the other benches use more of it")]
#[path = "../tests/stepped/mod.rs"]
mod stepped;

use core::hint::black_box;
use std::process::ExitCode;

use hpf_learn::{Cost, Draws, Parameters, Pi2, Pi2Options, Problem};
use stepped::prepared;

/// Rollouts of a batch.
const COUNT: usize = 8;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [task, part, times] = arguments[..] else {
        println!("run by scripts/instructions.sh, under valgrind");
        return ExitCode::SUCCESS;
    };
    let text = match task {
        "cantilever" => include_str!("../../../tasks/cantilever.toml"),
        "via_point" => include_str!("../../../tasks/via_point.toml"),
        _ => return ExitCode::FAILURE,
    };
    // Of the movement alone, without the rest time that its price adds.
    let text = &text.replace("\nrest = ", "\n# rest = ");
    let Ok(times) = times.parse::<u32>() else { return ExitCode::FAILURE };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        let (task, policy, simulation) = prepared(text);
        let options = Pi2Options { rollouts: COUNT, ..task.learning.pi2_options() };
        let learner = || Pi2::new(simulation.blocks(), simulation.steps(), policy.weights(), options).unwrap();
        let (batch, mut learner) = (learner().ask(), learner());
        let samples: [Parameters<'_>; COUNT] = core::array::from_fn(|k| batch.sample(k));
        let (mut workspace, mut costs) = (simulation.workspace(), vec![Cost::default(); COUNT]);
        let mut roll_out = || simulation.rollouts(Draws::Update(0), black_box(&samples), &mut workspace, &mut costs);
        match part {
            "rollouts" => (0..times).for_each(|_| roll_out()),
            "update" => {
                roll_out();
                (0..times).for_each(|_| drop(learner.tell(black_box(&batch), black_box(&costs))));
            }
            _ => return ExitCode::FAILURE,
        }
        ExitCode::SUCCESS
    })
}
