//! Logs as they are read back.

use std::fs;
use std::path::PathBuf;

use foxglove::messages::{FrameTransforms, SceneUpdate};
use hpf_sim::cost::Term;
use hpf_sim::{Policy, Simulation, Task};
use mcap::MessageStream;
use prost::Message as _;

use super::read::{Ending, summarize_bytes};
use super::*;

/// A beam and a turning axis, so that a log has everything in it.
const TASK: &str = r#"
    name = "press"
    duration = 2.0
    rate = 100.0
    axis = [{ name = "y", start = 0.0, goal = 0.032 }, { name = "roll", unit = "rad", start = 0.0, goal = 1.0 }]
    stiffness = { initial = 100.0, min = 30.0, max = 400.0 }
    damping = { initial = 50.0, min = 10.0, max = 100.0 }
    contact = { kind = "cantilever", axis = "y", length = 0.8, width = 0.05, thickness = 0.004, youngs_modulus = 200e9,
        force = 10.0 }
    cost = { tracking = 1e7, goal = 1e4 }
    learning = { updates = 4, rollouts = 5, seed = 3 }
    accept = { max_goal_error = 1e3, max_deviation = 1e-9 }
"#;

fn run() -> Run {
    let task = Task::parse(TASK).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let row = |update: usize| LearningRow {
        update,
        rollouts: 1 + 6 * update,
        total: 100.0 / (1 + update) as f64,
        terms: (0..Term::ALL.len()).map(|term| (10 * update + term) as f64).collect(),
        exploration: 0.5_f64.powi(update as i32),
    };
    let trajectory = simulation.rollout(&simulation.starting_weights(&policy).unwrap());
    Run { task, policy, learning: (0..=4).map(row).collect(), trajectory, snapshots: Vec::new() }
}

/// A path of this test's own.
fn path(test: &str) -> PathBuf {
    std::env::temp_dir().join(format!("hpf-{}-{test}.mcap", std::process::id()))
}

fn log_of(run: &Run, test: &str) -> Vec<u8> {
    let path = path(test);
    let metrics = Simulation::new(&run.task, &run.policy).unwrap().metrics(&run.trajectory);
    write(&path, &Head::new(&run.task, TASK, &run.policy.to_json()), run, &metrics).unwrap();
    let bytes = fs::read(&path).unwrap();
    fs::remove_file(&path).unwrap();
    bytes
}

/// Time [ns] and bytes of every message of `topic`; reading checks every CRC.
fn messages(bytes: &[u8], topic: &str) -> Vec<(u64, Vec<u8>)> {
    let all = MessageStream::new(bytes).unwrap().map(Result::unwrap);
    all.filter(|message| message.channel.topic == topic).map(|m| (m.log_time, m.data.into_owned())).collect()
}

#[test]
fn a_log_reads_back() {
    let run = run();
    let bytes = log_of(&run, "reads_back");
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let counts: Vec<(String, u64)> =
        Topic::ALL.iter().map(|topic| (topic.name().to_owned(), messages(&bytes, topic.name()).len() as u64)).collect();
    let expected = [201, 201, 201, 1, 1, 102, 6, 201, 5, 201];
    assert!(counts.iter().map(|(_, count)| *count).eq(expected), "{counts:?}");
    let stats = summary.stats.unwrap();
    assert_eq!((stats.message_start_time, stats.message_end_time), (0, 2_000_000_000));
    assert_eq!((stats.attachment_count, stats.metadata_count), (2, 1));

    let names: Vec<_> = summary.attachment_indexes.iter().map(|a| (a.name.as_str(), a.log_time)).collect();
    assert_eq!(names, [("task.toml", 0), ("policy.json", 0)]);
    let task = mcap::read::attachment(&bytes, &summary.attachment_indexes[0]).unwrap();
    assert_eq!(task.data, TASK.as_bytes());
    let policy = mcap::read::attachment(&bytes, &summary.attachment_indexes[1]).unwrap();
    assert_eq!(policy.data, run.policy.to_json().as_bytes());
    let metadata = mcap::read::metadata(&bytes, &summary.metadata_indexes[0]).unwrap();
    assert_eq!((metadata.name.as_str(), metadata.metadata["seed"].as_str()), ("hpf.run", "3"));
    assert!(summary.metadata_indexes[0].offset < summary.attachment_indexes[0].offset);
    assert!(summary.attachment_indexes[1].offset < summary.chunk_indexes[0].chunk_start_offset);

    let mut times = MessageStream::new(&bytes).unwrap().map(|message| message.unwrap().log_time);
    let mut last = times.next().unwrap();
    assert!(times.all(|time| core::mem::replace(&mut last, time) <= time), "messages stand in the order of time");
}

#[test]
fn messages_hold_the_run() {
    let run = run();
    let bytes = log_of(&run, "holds");
    let (time, state) = &messages(&bytes, "/hpf/state")[100];
    let state = proto::State::decode(state.as_slice()).unwrap();
    let (y, roll) = (&run.trajectory.axes[0], &run.trajectory.axes[1]);
    assert_eq!((*time, state.time_s), (1_000_000_000, run.trajectory.time[100]));
    assert_eq!(state.linear_axes[0].position_m, y.position[100]);
    assert_eq!(state.rotary_axes[0].stiffness_n_m_per_rad, roll.stiffness[100]);
    let contact = state.contact.unwrap();
    assert_eq!((contact.axis.as_str(), contact.set_point_force_n), ("y", 10.0));

    let updates = messages(&bytes, "/hpf/update");
    assert!(updates.iter().map(|(time, _)| *time).eq([0, 500_000_000, 1_000_000_000, 1_500_000_000, 2_000_000_000]));
    let update = proto::Update::decode(updates[2].1.as_slice()).unwrap();
    assert_eq!((update.update, update.rollouts, update.total_cost), (2, 13, 100.0 / 3.0));
    assert_eq!((update.goal_cost, update.damping_cost, update.exploration), (20.0, 27.0, 0.25));

    let transforms = FrameTransforms::decode(messages(&bytes, "/tf")[200].1.as_slice()).unwrap().transforms;
    let translation = transforms[0].translation.unwrap();
    assert_eq!((translation.x, translation.z), (0.8, -y.position[200]), "at the tip, as deep as the axis says");
    let scene = messages(&bytes, "/scene");
    let ids = |i: usize| -> Vec<String> {
        SceneUpdate::decode(scene[i].1.as_slice()).unwrap().entities.into_iter().map(|entity| entity.id).collect()
    };
    assert_eq!((ids(0), ids(1)), (vec!["path".into(), "targets".into()], vec!["force".into(), "stiffness".into()]));
    let last = &messages(&bytes, "/log")[5].1;
    let verdict = foxglove::messages::Log::decode(last.as_slice()).unwrap().message;
    assert!(verdict.starts_with("pass: max_goal_error"), "{verdict}");
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    assert_eq!(log_of(&run(), "same_a"), log_of(&run(), "same_b"));
}

#[test]
fn every_finished_update_is_on_disk_while_learning() {
    let run = run();
    let path = path("partial");
    let mut log = Log::create(&path, &Head::new(&run.task, TASK, &run.policy.to_json())).unwrap();
    for (i, row) in run.learning.iter().enumerate() {
        log.update(row).unwrap();
        let found = summarize(&path).unwrap();
        assert_eq!(found.ending, Ending::Truncated);
        assert_eq!((found.chunks, found.topics["/hpf/update"].messages), (i as u64 + 1, i as u64 + 1));
        assert_eq!(found.attachments.len(), 2);
    }
    // The complete log takes the name; the open file does not get in its way.
    let again = Log::create(&path, &Head::new(&run.task, TASK, &run.policy.to_json())).unwrap();
    log.finish().unwrap();
    again.finish().unwrap();
    let found = summarize(&path).unwrap();
    assert_eq!((found.ending, found.topics["/hpf/update"].messages), (Ending::Complete, 0));
    fs::remove_file(&path).unwrap();
}

#[test]
fn a_truncated_log_gives_all_its_whole_chunks() {
    let bytes = log_of(&run(), "truncated");
    let chunks = mcap::Summary::read(&bytes).unwrap().unwrap().chunk_indexes;
    assert!(chunks.len() > 3);
    let ends: Vec<u64> = chunks.iter().map(|chunk| chunk.chunk_start_offset + chunk.chunk_length).collect();
    let cuts = (8..bytes.len()).step_by(997).chain(ends.iter().flat_map(|&end| [end as usize - 1, end as usize]));
    for cut in cuts {
        let found = summarize_bytes(&bytes[..cut], cut as u64).unwrap();
        assert_eq!(found.ending, Ending::Truncated, "at {cut}");
        assert_eq!(found.chunks, ends.iter().filter(|&&end| end <= cut as u64).count() as u64, "at {cut}");
    }
    let whole = summarize_bytes(bytes.as_slice(), bytes.len() as u64).unwrap();
    assert_eq!((whole.ending, whole.chunks), (Ending::Complete, chunks.len() as u64));
    for short in 0..8 {
        assert!(summarize_bytes(&bytes[..short], short as u64).is_err());
    }
}

#[test]
fn a_damaged_log_is_called_so() {
    let bytes = log_of(&run(), "damaged");
    for at in (8..bytes.len() - 8).step_by(211) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0xa5;
        let found = summarize_bytes(bytes.as_slice(), bytes.len() as u64).unwrap();
        assert_ne!(found.ending, Ending::Complete, "at {at}");
    }
    assert!(summarize_bytes(&b"name = \"a task, not a log\""[..], 25).is_err());
}

#[test]
fn lengths_in_a_file_are_not_believed() {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat();
    let chunk = |compression: &str, size: u64, records: &[u8]| {
        let sizes = [[0; 16].as_slice(), &size.to_le_bytes(), &[0; 4]].concat();
        [sizes, text(compression), (records.len() as u64).to_le_bytes().to_vec(), records.to_vec()].concat()
    };
    let huge = [[5].as_slice(), &u64::MAX.to_le_bytes(), &[0; 22]].concat();
    let cases: [(u8, u64, Vec<u8>); 7] = [
        (6, u64::MAX, chunk("zstd", u64::MAX, &[])), // open, as other writers leave it
        (5, u64::MAX - 8, vec![0; 22]),
        (6, 0, chunk("", 31, &huge)),
        (6, 0, chunk("zstd", u64::MAX, &huge)),
        (6, 0, chunk("lz4", 1 << 40, &huge)),
        (9, 0, [[0; 16].as_slice(), &text("a"), &text("b"), &u64::MAX.to_le_bytes()].concat()),
        (12, 0, [text("a"), u32::MAX.to_le_bytes().to_vec()].concat()),
    ];
    for (i, (opcode, length, record)) in cases.into_iter().enumerate() {
        let length = if length == 0 { record.len() as u64 } else { length };
        let bytes = [mcap::MAGIC, &[opcode], &length.to_le_bytes(), &record].concat();
        let found = summarize_bytes(bytes.as_slice(), bytes.len() as u64).unwrap();
        assert_eq!((found.chunks, found.messages), (0, 0), "case {i}");
        assert_ne!(found.ending, Ending::Complete, "case {i}");
    }
}
