//! Logs as they are read back.

use std::fs;
use std::path::PathBuf;

use foxglove::messages::{FrameTransforms, SceneUpdate};
use hpf_sim::cost::Term;
use hpf_sim::{Policy, Simulation, Task};
use mcap::MessageStream;
use prost::Message as _;

use super::read::{Ending, summarize_bytes};
use super::recover::recover;
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
    let (snapshots, demonstrations) = (Vec::new(), Vec::new());
    Run { task, policy, learning: (0..=4).map(row).collect(), trajectory, snapshots, demonstrations }
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
    // 2 s of movement and 1.27 s of rest at 100 Hz.
    let expected = [328, 328, 328, 1, 1, 165, 6, 328, 5, 328];
    assert!(counts.iter().map(|(_, count)| *count).eq(expected), "{counts:?}");
    let stats = summary.stats.unwrap();
    assert_eq!((stats.message_start_time, stats.message_end_time), (0, 3_270_000_000));
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
        let bytes = [MAGIC, &[opcode], &length.to_le_bytes(), &record].concat();
        let found = summarize_bytes(bytes.as_slice(), bytes.len() as u64).unwrap();
        assert_eq!((found.chunks, found.messages), (0, 0), "case {i}");
        assert_ne!(found.ending, Ending::Complete, "case {i}");
    }
}

/// A message as the strict reader gives it: topic, time and bytes.
type Message = (String, u64, Vec<u8>);

/// Every message of a log, and the chunks they are in, by where these begin and end.
fn by_chunk(bytes: &[u8]) -> Vec<(core::ops::Range<usize>, Vec<Message>)> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let chunk = |index: &mcap::records::ChunkIndex| {
        let begin = index.chunk_start_offset as usize;
        let messages = summary.stream_chunk(bytes, index).unwrap().map(Result::unwrap);
        let messages = messages.map(|m| (m.channel.topic.clone(), m.log_time, m.data.into_owned())).collect();
        (begin..begin + index.chunk_length as usize, messages)
    };
    summary.chunk_indexes.iter().map(chunk).collect()
}

/// All messages of a log that was rescued; every checksum and the index are right.
fn strictly(bytes: &[u8]) -> Vec<Message> {
    assert_eq!(summarize_bytes(bytes, bytes.len() as u64).unwrap().ending, Ending::Complete);
    by_chunk(bytes).into_iter().flat_map(|(_, messages)| messages).collect()
}

#[test]
fn recovery_of_a_cut_log_keeps_every_whole_chunk() {
    let bytes = log_of(&run(), "recover_cut");
    let chunks = by_chunk(&bytes);
    let all: Vec<Message> = chunks.iter().flat_map(|(_, messages)| messages.clone()).collect();
    let ends = chunks.iter().flat_map(|(place, _)| [place.end - 1, place.end, place.end + 1]);
    for cut in (0..bytes.len()).step_by(bytes.len() / 200).chain(ends) {
        let Ok(found) = recover(&bytes[..cut]) else {
            assert!(cut < 600, "nothing is found in {cut} bytes");
            continue;
        };
        let rescued = strictly(&found.bytes);
        assert!(rescued == all[..rescued.len()], "at {cut}: what is rescued is the beginning of what there was");
        let whole: usize =
            chunks.iter().filter(|(place, _)| place.end <= cut).map(|(_, messages)| messages.len()).sum();
        assert!(rescued.len() >= whole, "at {cut}: {} of {whole} messages", rescued.len());
        assert_eq!((found.messages, found.damaged, found.orphans), (rescued.len() as u64, 0, 0), "at {cut}");
        assert_eq!(found.ending, Ending::Truncated, "at {cut}");
        if whole > 0 {
            assert_eq!((found.metadata.len(), found.attachments.len()), (1, 2), "at {cut}");
        }
    }
    let whole = recover(&bytes).unwrap();
    assert!(strictly(&whole.bytes) == all && whole.ending == Ending::Complete && whole.last_update == Some(4));
}

#[test]
fn recovery_of_a_damaged_log_keeps_every_other_chunk() {
    let bytes = log_of(&run(), "recover_damaged");
    let chunks = by_chunk(&bytes);
    let lengths = chunks.iter().flat_map(|(place, _)| (place.start..place.start + 60).chain(place.end..place.end + 20));
    // The kind of every record of the index; one of them becomes a message.
    let mut kinds = Vec::new();
    let mut at = chunks.iter().map(|(place, _)| place.end).max().unwrap();
    while at + MAGIC.len() < bytes.len() {
        kinds.push(at);
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
    }
    for at in (0..bytes.len()).step_by(bytes.len() / 200).chain(lengths).chain(kinds) {
        for flip in [0x01, 0xff] {
            let mut damaged = bytes.clone();
            damaged[at] ^= flip;
            let found = recover(&damaged).unwrap();
            let rescued = strictly(&found.bytes);
            let expected = chunks.iter().filter(|(place, _)| !place.contains(&at)).flat_map(|(_, messages)| messages);
            let mut rest = rescued.iter();
            for message in expected {
                assert!(rest.any(|found| found == message), "{flip:#x} at {at}: a message of a whole chunk is lost");
            }
            let mut all = chunks.iter().flat_map(|(_, messages)| messages);
            for message in &rescued {
                assert!(all.any(|there| there == message), "{flip:#x} at {at}: {message:?} was not there");
            }
            assert_ne!(found.ending, Ending::Complete, "{flip:#x} at {at}");
        }
    }
}

#[test]
fn recovery_reads_a_chunk_that_was_never_closed() {
    let run = run();
    let whole = log_of(&run, "recover_open");
    let first = by_chunk(&whole).remove(0);
    let messages: Vec<u8> = (0..50_u64)
        .flat_map(|i| {
            let fields = [&1_u16.to_le_bytes()[..], &[0; 4], &i.to_le_bytes(), &i.to_le_bytes(), &[7; 100]].concat();
            [&[5][..], &(fields.len() as u64).to_le_bytes(), &fields].concat()
        })
        .collect();
    let packed = zstd::encode_all(messages.as_slice(), 3).unwrap();
    for (compression, records) in [("", messages), ("zstd", packed)] {
        // As writers that seek leave it: every length, size and checksum is still to come.
        let name = [&(compression.len() as u32).to_le_bytes()[..], compression.as_bytes()].concat();
        let chunk = [&[6][..], &[0xff; 8], &[0; 16], &[0xff; 8], &[0xff; 4], &name, &[0xff; 8], &records].concat();
        let open = [&whole[..first.0.end], &chunk].concat();
        let found = recover(&open).unwrap();
        assert_eq!(found.messages, first.1.len() as u64 + 50, "{compression}");
        assert_eq!((found.chunks, found.from_cut_chunk, found.strange_bytes), (1, 50, 0), "{compression}");
        let rescued = strictly(&found.bytes);
        assert!(rescued[..first.1.len()] == first.1[..] && rescued.last().unwrap().1 == 49, "{compression}");
    }
}

#[test]
fn recovery_believes_no_length_and_refuses_what_is_no_log() {
    assert!(recover(b"").is_err() && recover(&MAGIC[..5]).is_err() && recover(MAGIC).is_err());
    assert!(recover(TASK.as_bytes()).unwrap_err().to_string().contains("this is not an MCAP file"));
    let mut random = 1_u32;
    let noise: Vec<u8> = core::iter::repeat_with(|| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 24) as u8
    })
    .take(100_000)
    .collect();
    assert!(recover(&noise).is_err());
    for opcode in [1, 3, 4, 5, 6, 9, 12, 0x80] {
        for length in [0_u64, 40, 1 << 40, u64::MAX - 8, u64::MAX] {
            let bytes = [MAGIC, &[opcode], &length.to_le_bytes(), &[0xff; 40]].concat();
            if let Ok(found) = recover(&bytes) {
                assert_eq!((found.messages, found.chunks), (0, 0), "{opcode:#x}, {length}");
                strictly(&found.bytes);
            }
        }
    }
}
