//! What is in a log, as text and as JSON.

use std::fmt;

use serde_json::{Value, json};

use super::read::{Ending, Summary};
use crate::escape::line;

impl Ending {
    /// The ending in one word.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Truncated => "truncated",
            Self::Damaged(_) => "damaged",
        }
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Damaged(reason) => write!(f, "damaged ({reason})"),
            whole_or_cut => f.write_str(whole_or_cut.word()),
        }
    }
}

impl Summary {
    /// The same as one JSON object.
    pub fn to_json(&self) -> Value {
        let topics = self.topics.iter().map(|(name, topic)| {
            json!({
                "name": name,
                "messages": topic.messages,
                "encoding": topic.encoding,
                "schema": topic.schema,
                "schema_encoding": topic.schema_encoding,
            })
        });
        let attachments = self
            .attachments
            .iter()
            .map(|(name, media_type, size)| json!({ "name": name, "media_type": media_type, "bytes": size }));
        json!({
            "format": "hpf-log-info",
            "version": 1,
            "ending": self.ending.word(),
            "damage": match &self.ending { Ending::Damaged(reason) => Some(reason), _ => None },
            "library": self.library,
            "chunks": self.chunks,
            "messages": self.messages,
            "orphans": self.orphans.values().sum::<u64>(),
            "logs": 1 + self.followers,
            "start_s": self.times.map(|(start, _)| seconds(start)),
            "end_s": self.times.map(|(_, end)| seconds(end)),
            "topics": topics.collect::<Vec<_>>(),
            "attachments": attachments.collect::<Vec<_>>(),
            "metadata": self.metadata,
        })
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let up_to = if self.ending == Ending::Complete { "" } else { "; up to there" };
        write!(f, "{}{up_to}: {} messages in {} chunks", self.ending, self.messages, self.chunks)?;
        if let Some((start, end)) = self.times {
            write!(f, ", from {} s to {} s", seconds(start), seconds(end))?;
        }
        writeln!(f, ", written by {}", if self.library.is_empty() { "?".into() } else { line(&self.library) })?;
        if self.followers > 0 {
            writeln!(f, "{} logs one behind the other in this file", 1 + self.followers)?;
        }
        for (channel, messages) in &self.orphans {
            let noun = if *messages == 1 { "message" } else { "messages" };
            writeln!(f, "{messages} {noun} of channel {channel}, which nothing defines")?;
        }
        for (name, topic) in &self.topics {
            let schema = if topic.schema.is_empty() { "-".into() } else { line(&topic.schema) };
            let (name, encoding) = (line(name), line(&topic.encoding));
            writeln!(f, "topic {name:<18} {:>8} messages  {encoding:<8} {schema}", topic.messages)?;
        }
        for (name, media_type, size) in &self.attachments {
            let (name, media_type) = (line(name), line(media_type));
            writeln!(f, "attachment {name:<13} {size:>8} bytes     {media_type}")?;
        }
        for (name, pairs) in &self.metadata {
            writeln!(f, "metadata {}", line(name))?;
            for (key, value) in pairs {
                let (key, value) = (line(key), line(value));
                writeln!(f, "  {key:<22} {value}")?;
            }
        }
        Ok(())
    }
}

/// A time [ns] in s.
fn seconds(nanoseconds: u64) -> f64 {
    nanoseconds as f64 / 1e9
}
