//! `log.mcap`: a run on one time line, for Foxglove, Rerun and PlotJuggler.
//!
//! First the metadata `hpf.run` and the attachments task.toml and policy.json, then messages in the order of time,
//! in chunks of 32 KiB compressed with zstd. Time is the movement's: it starts at 0, and nothing in the file depends on
//! the clock or the number of threads, so the same seed gives the same bytes. Learning updates are spread evenly over
//! the duration. The file only ever grows: a chunk is made in memory and written whole, so that whenever a program is
//! killed, all but the last record is there.

mod bag;
mod fields;
mod motion;
mod proto;
mod read;
mod recover;
mod ros2;
mod scan;
mod scene;
mod show;
mod space;
#[cfg(test)]
mod tests;
mod topic;
mod work;

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, BufWriter};
use std::path::Path;

use foxglove::messages::Timestamp;
use foxglove::messages::log::Level;
use hpf_sim::Metric;
use hpf_sim::task::Task;
use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{Attachment, McapError, WriteOptions};
use prost::Message;

pub use mcap::MAGIC;

pub use self::bag::bag;
pub use self::read::{Ending, Summary, summarize, summarize_bytes};
pub use self::recover::{Recovered, recover};
use self::topic::Topic;
use crate::files::sha256;
use crate::nodes;
use crate::results::{LearningRow, Run};

/// Version of what is in a log, in its metadata.
const VERSION: &str = "1";
/// Size of a chunk before it is compressed [bytes].
const CHUNK: u64 = 32 << 10;
/// The frame that does not move.
const WORLD: &str = "world";

/// What stands first in a log.
pub struct Head<'a> {
    task: &'a Task,
    task_toml: &'a str,
    policy_json: &'a str,
}

impl<'a> Head<'a> {
    /// The head of a run of `task`, its text, and the text of the policy: while learning, of the one it starts from.
    pub fn new(task: &'a Task, task_toml: &'a str, policy_json: &'a str) -> Self {
        Self { task, task_toml, policy_json }
    }

    /// What can be said of a run in words; the same for every run of the same seed.
    fn metadata(&self) -> BTreeMap<String, String> {
        let pairs = [
            ("task", self.task.name.clone()),
            ("method", self.task.learning.method.name().to_owned()),
            ("seed", self.task.learning.seed.to_string()),
            ("duration_s", self.task.duration.to_string()),
            ("rate_hz", self.task.rate.to_string()),
            ("task_sha256", sha256(self.task_toml)),
            ("policy_sha256", sha256(self.policy_json)),
            ("hpf_version", env!("CARGO_PKG_VERSION").to_owned()),
            ("log_version", VERSION.to_owned()),
        ];
        pairs.into_iter().map(|(key, value)| (key.to_owned(), value)).collect()
    }
}

/// A log being written.
pub struct Log {
    writer: mcap::Writer<NoSeek<BufWriter<File>>>,
    /// Of each topic, in the order of [`Topic::ALL`].
    channels: Vec<u16>,
    buffer: Vec<u8>,
    /// Duration of the movement [s].
    duration: f64,
    /// Updates that share it: the planned ones, until it is known how many were made.
    updates: usize,
}

impl Log {
    /// Begins a log; what is at `path` is not kept.
    ///
    /// # Errors
    /// What the system says.
    pub fn create(path: &Path, head: &Head<'_>) -> io::Result<Self> {
        let file = BufWriter::new(nodes::create(path)?);
        Self::begin(NoSeek::new(file), head).map_err(to_io)
    }

    fn begin(file: NoSeek<BufWriter<File>>, head: &Head<'_>) -> Result<Self, McapError> {
        let mut writer = options().create(file)?;
        writer.write_metadata(&Metadata { name: "hpf.run".into(), metadata: head.metadata() })?;
        let files =
            [("task.toml", "application/toml", head.task_toml), ("policy.json", "application/json", head.policy_json)];
        for (name, media_type, text) in files {
            writer.attach(&Attachment {
                log_time: 0,
                create_time: 0,
                name: name.into(),
                media_type: media_type.into(),
                data: Cow::Borrowed(text.as_bytes()),
            })?;
        }
        let mut channels = Vec::new();
        for topic in Topic::ALL {
            let schema = topic.schema();
            let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data)?;
            channels.push(writer.add_channel(schema, topic.name(), topic.encoding(), &BTreeMap::new())?);
        }
        let mut log = Self {
            writer,
            channels,
            buffer: Vec::new(),
            duration: head.task.duration,
            updates: head.task.learning.updates.max(1),
        };
        let Task { name, duration, rate, axis, learning, .. } = head.task;
        let axes: Vec<&str> = axis.iter().map(|axis| axis.name.as_str()).collect();
        let (axes, method, seed) = (axes.join(", "), learning.method.name(), learning.seed);
        log.say(0, Level::Info, format!("task {name}: axes {axes}; {duration} s at {rate} Hz"))?;
        log.say(0, Level::Info, format!("method {method}, seed {seed}"))?;
        Ok(log)
    }

    /// Logs one update as a finished chunk, so that it outlives the program.
    ///
    /// # Errors
    /// What the system says.
    pub fn update(&mut self, row: &LearningRow) -> io::Result<()> {
        self.put_update(row).and_then(|()| self.writer.flush()).map_err(to_io)
    }

    /// Writes what makes the file complete: index, statistics, checksums.
    ///
    /// # Errors
    /// What the system says.
    pub fn finish(mut self) -> io::Result<()> {
        self.writer.finish().map_err(to_io)?;
        let file = self.writer.into_inner().into_inner();
        file.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()
    }

    fn put_update(&mut self, row: &LearningRow) -> Result<(), McapError> {
        let mut terms = row.terms.iter().copied();
        let mut term = || terms.next().unwrap_or_default();
        let message = proto::Update {
            update: row.update as u64,
            rollouts: row.rollouts as u64,
            total_cost: row.total,
            exploration: row.exploration,
            goal_cost: term(),
            end_velocity_cost: term(),
            via_point_cost: term(),
            tracking_cost: term(),
            contact_force_cost: term(),
            acceleration_cost: term(),
            stiffness_cost: term(),
            damping_cost: term(),
            rest_cost: term(),
        };
        self.send(Topic::Update, self.update_time(row), &message)
    }

    /// When an update stands on the time line [ns].
    fn update_time(&self, row: &LearningRow) -> u64 {
        let share = row.update as f64 / self.updates as f64;
        nanoseconds(self.duration * share.min(1.0))
    }

    fn say(&mut self, time: u64, level: Level, message: String) -> Result<(), McapError> {
        let line = foxglove::messages::Log {
            timestamp: Some(timestamp(time)),
            level: level.into(),
            message,
            name: "hpf".into(),
            ..Default::default()
        };
        self.send(Topic::Log, time, &line)
    }

    fn send(&mut self, topic: Topic, time: u64, message: &impl Message) -> Result<(), McapError> {
        let mut buffer = core::mem::take(&mut self.buffer);
        buffer.clear();
        message.encode(&mut buffer).expect("a vector grows to what is written to it");
        let sent = self.send_bytes(topic, time, &buffer);
        self.buffer = buffer;
        sent
    }

    fn send_bytes(&mut self, topic: Topic, time: u64, bytes: &[u8]) -> Result<(), McapError> {
        let channel_id = self.channels[topic as usize];
        let header = MessageHeader { channel_id, sequence: 0, log_time: time, publish_time: time };
        self.writer.write_to_known_channel(&header, bytes)
    }
}

/// Writes the log of a run, with the measures of its motion, under a temporary name, and renames it. The log of learning
/// beside it, which a kill leaves readable until then, is removed after that.
///
/// # Errors
/// What the system says; what was at `path` is untouched then.
pub fn write(path: &Path, head: &Head<'_>, run: &Run, metrics: &[Metric]) -> io::Result<()> {
    let partial = path.with_added_extension("partial.new");
    let written = Log::create(&partial, head).and_then(|mut log| {
        log.run(run, metrics).map_err(to_io)?;
        log.finish()
    });
    let written = written.inspect_err(|_| {
        // The error to report is the first one; a leftover is removed as far as possible.
        let _ = fs::remove_file(&partial);
    });
    let of_learning = path.with_added_extension("partial");
    written.and_then(|()| nodes::settle(&partial, path)).and_then(|()| match fs::remove_file(of_learning) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    })
}

/// How logs are written.
fn options() -> WriteOptions {
    WriteOptions::new()
        .library(concat!("hpf ", env!("CARGO_PKG_VERSION")))
        .chunk_size(Some(CHUNK))
        // One thread: with more, the bytes would be others.
        .compression_threads(0)
        .disable_seeking(true)
}

/// What the user should know of the time in the log of a run of `task`: messages count in nanoseconds, the stamps
/// of ROS in seconds of 32 bits.
pub fn time_note(task: &Task) -> Option<String> {
    let (step, end) = (task.rate.recip(), task.duration + task.rest_time());
    let most = f64::from(i32::MAX);
    if end > most {
        Some(format!("time stamps of ROS messages end at {most} s: what comes later stands there"))
    } else if step < 1e-9 {
        Some(format!("logs count time in nanoseconds and a step takes {step:e} s: several stand at the same time"))
    } else {
        None
    }
}

/// A time [s] in ns.
fn nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}

fn timestamp(nanoseconds: u64) -> Timestamp {
    let seconds = u32::try_from(nanoseconds / 1_000_000_000).unwrap_or(u32::MAX);
    Timestamp::new(seconds, (nanoseconds % 1_000_000_000) as u32)
}

fn to_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}
