//! Everything that reads what others may have written, as functions of any bytes: for fuzz targets and tests.
//!
//! A function says whether the bytes are accepted. It panics where something fails that must hold whatever the bytes
//! are: a refusal has a message and a place within the text, and what is accepted survives writing and reading.

use std::sync::LazyLock;

use hpf_core::packed::{Packed, crc32};
use hpf_recordings::Mapping;
use hpf_sim::task::Task;
use hpf_sim::{Conditions, Policy, Simulation};

use crate::export::{Format, Precision, export};
use crate::failure::in_text;
#[cfg(feature = "logs")]
use crate::log;
use crate::{files, overrides, results};

/// A reader: whether it accepts these bytes.
pub type Reader = fn(&[u8]) -> bool;

/// Every reader by its name, that of its fuzz target and of the folder of its seeds.
pub const ALL: &[(&str, Reader)] = &[
    ("task", task),
    ("overrides", overrides),
    ("policy", policy),
    ("packed", packed),
    ("tables", tables),
    ("demonstrations", demonstrations),
    #[cfg(feature = "logs")]
    ("mcap", mcap),
];

/// A task is simulated where it has fewer numbers than this: more would only be slow.
const MOST_SIMULATED: usize = 50_000;

fn text(bytes: &[u8]) -> Option<&str> {
    str::from_utf8(bytes).ok()
}

/// A task file. A small one is simulated once.
pub fn task(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else { return false };
    let task = match Task::parse(text) {
        Ok(task) => task,
        Err(found) => {
            assert!(!found.is_empty(), "a refusal without a reason");
            for diagnostic in &found {
                assert!(text.get(diagnostic.span.clone()).is_some(), "{diagnostic:?} is not in the text");
            }
            assert!(!in_text("task.toml")(found).to_string().is_empty());
            return false;
        }
    };
    let bases = [task.movement.basis, task.stiffness.basis, task.damping.basis];
    let functions: usize = bases.iter().map(|basis| basis.count()).sum();
    if task.steps() * functions * task.axis.len() <= MOST_SIMULATED
        && let Ok(policy) = Policy::initial(&task)
        && let Ok(simulation) = Simulation::new(&task, &policy)
        && let Ok(weights) = simulation.starting_weights(&policy)
    {
        let trace = simulation.rollout(&weights);
        assert_eq!((trace.time.len(), trace.steps()), (task.steps() + task.rest_steps() + 1, task.steps()));
        simulation.metrics(&trace);
    }
    true
}

/// An override in the first line, and the task file it changes in the others.
pub fn overrides(bytes: &[u8]) -> bool {
    let Some((change, rest)) = text(bytes).and_then(|text| text.split_once('\n')) else { return false };
    match overrides::apply(rest, &[change.to_owned()]) {
        Ok(changed) => task(changed.as_bytes()),
        Err(failure) => {
            assert!(!failure.to_string().is_empty());
            false
        }
    }
}

/// A policy file: through JSON and the packed form to the bit, and certified.
pub fn policy(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else { return false };
    let policy = match Policy::parse(text) {
        Ok(policy) => policy,
        Err(error) => {
            assert!(!error.to_string().is_empty());
            return false;
        }
    };
    let again = Policy::parse(&policy.to_json()).expect("a policy that was read can be read again");
    assert_eq!(bits(&policy.weights()), bits(&again.weights()));
    assert_eq!(policy, again);
    let rate = 10.0 / policy.duration_s;
    let _ = policy.certify(&Conditions::new(rate, 1.0 / rate, 10.0));
    for format in [Format::Binary, Format::C, Format::Rust] {
        let form = format.firmware().expect("these forms are for firmware");
        let _ = export(&policy, form, Precision::F32);
        if let (Format::Binary, Ok(bytes)) = (format, export(&policy, form, Precision::F64)) {
            let packed = Packed::parse(&bytes).expect("an exported policy can be read");
            let numbers = bits(&packed.values::<f64>().collect::<Vec<_>>());
            assert!(bits(&policy.axes[0].movement.weights).iter().all(|weight| numbers.contains(weight)));
        }
    }
    true
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|number| number.to_bits()).collect()
}

/// A packed skill, as it is and under a checksum that fits.
pub fn packed(bytes: &[u8]) -> bool {
    let is_accepted = unpack(bytes);
    if let Some(body) = bytes.len().checked_sub(4) {
        let sum = crc32(&bytes[..body]).to_le_bytes();
        unpack(&[&bytes[..body], &sum[..]].concat());
    }
    is_accepted
}

fn unpack(bytes: &[u8]) -> bool {
    let Ok(packed) = Packed::parse(bytes) else { return false };
    assert_eq!(packed.values::<f64>().count(), packed.head().numbers());
    assert!(!crate::packed::text(&packed).is_empty() && crate::packed::to_json(&packed).is_object());
    let mut storage = vec![0.0; packed.head().storage()];
    let skills = [
        packed.skill_in::<f64, 1>(&mut storage).is_ok(),
        packed.skill_in::<f64, 2>(&mut storage).is_ok(),
        packed.skill::<f32, 3, 1>().is_ok(),
    ];
    assert!(skills[..2].iter().filter(|is_skill| **is_skill).count() < 2, "a skill has one number of axes");
    true
}

/// A recording of any format, by the names of its columns and by other options: its signals are finite and as long as its
/// time, which rises.
pub fn demonstrations(bytes: &[u8]) -> bool {
    let time = "#1".parse().expect("this is a column");
    let axes = vec!["x=#2:mm".parse().expect("this is an axis")];
    let numbered = Mapping { time: Some(time), axes, bridge: true, trim: true, ..Mapping::default() };
    let even = Mapping { sample_rate: Some(100.0), ignore_rest: true, ..Mapping::default() };
    let preset = Mapping { preset: Some(hpf_recordings::Preset::Optitrack), ..Mapping::default() };
    let read = [Mapping::default(), numbered, even, preset].map(|mapping| recording(bytes, &mapping));
    if let Ok(saw) = hpf_recordings::inspect(bytes, &Mapping::default()) {
        assert!(!saw.to_string().is_empty());
    }
    read[0]
}

fn recording(bytes: &[u8], mapping: &Mapping) -> bool {
    match hpf_recordings::read(bytes, mapping) {
        Ok(read) => {
            let time = &read.recording.time;
            assert!(read.recording.duration() > 0.0 && time.windows(2).all(|pair| pair[0] < pair[1]));
            for axis in &read.recording.axes {
                assert!(axis.position.len() == time.len() && axis.position.iter().all(|position| position.is_finite()));
            }
            true
        }
        Err(refusal) => {
            assert!(refusal.mistakes.iter().all(|mistake| !mistake.message.is_empty()));
            assert!(!refusal.mistakes.is_empty());
            false
        }
    }
}

/// A table: the header says which. Trajectories and demonstrations are of a small task with two axes and a contact.
pub fn tables(bytes: &[u8]) -> bool {
    let Some(text) = text(bytes) else { return false };
    if let Ok(trace) = results::read_trajectory(&TABLE_TASK, text) {
        let again = results::read_trajectory(&TABLE_TASK, &results::trajectory_csv(&TABLE_TASK, &trace));
        assert_eq!(format!("{trace:?}"), format!("{:?}", again.expect("a trajectory that was read can be read again")));
        return true;
    }
    if let Ok(rows) = results::read_learning(text) {
        let again = results::read_learning(&results::learning_csv(&rows));
        assert_eq!(format!("{rows:?}"), format!("{:?}", again.expect("rows that were read can be read again")));
        return true;
    }
    if let Ok(demonstrations) = results::demonstrations::read(&TABLE_TASK, text) {
        let count = TABLE_TASK.steps() + 1;
        let axes = demonstrations.iter().inspect(|axes| assert_eq!(axes.len(), TABLE_TASK.axis.len())).flatten();
        axes.for_each(|positions| assert_eq!(positions.len(), count));
        return true;
    }
    match files::parse_table(text) {
        Ok(samples) => {
            assert!(samples.rows().all(|(time, force)| time.is_finite() && force.is_finite()));
            true
        }
        Err((line, column, message)) => {
            assert!(line >= 1 && column >= 1 && !message.is_empty());
            false
        }
    }
}

/// The task whose trajectories [`tables`] reads.
static TABLE_TASK: LazyLock<Task> = LazyLock::new(|| {
    Task::parse(
        r#"
name = "table"
duration = 1.0
rate = 4.0
[[axis]]
name = "x"
start = 0.0
goal = 1.0
[[axis]]
name = "q"
unit = "rad"
start = 0.0
goal = 1.0
[stiffness]
initial = 100
min = 10
max = 1000
[damping]
initial = 20
min = 1
max = 100
[contact]
kind = "wall"
axis = "x"
position = 0.9
stiffness = 1000.0
[cost]
goal = 1.0
"#,
    )
    .expect("the task is valid")
});

/// A log: looked into, and what is whole of it rescued.
#[cfg(feature = "logs")]
pub fn mcap(bytes: &[u8]) -> bool {
    if let Ok(recovered) = log::recover(bytes) {
        let rescued = &recovered.bytes;
        let again = log::summarize_bytes(rescued.as_slice(), rescued.len() as u64).expect("a rescued log is a log");
        assert_eq!((again.ending, again.messages), (log::Ending::Complete, recovered.messages));
    }
    match log::summarize_bytes(bytes, bytes.len() as u64) {
        Ok(summary) => {
            let per_topic: u64 = summary.topics.values().map(|topic| topic.messages).sum();
            assert_eq!(summary.messages, per_topic, "every message is of a topic");
            assert!(!summary.to_string().is_empty() && summary.to_json().is_object());
            true
        }
        Err(error) => {
            assert!(!error.to_string().is_empty());
            false
        }
    }
}
