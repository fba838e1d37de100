//! `hpf recover`: what is whole in a truncated or damaged log.

use core::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::json;

use crate::cli::{Common, Recover};
use crate::deliver::deliver;
use crate::outcome::Outcome;
use hpf::failure::Failure;
use hpf::files::{in_file, read_bytes};
use hpf::log::{self, Ending, Recovered};

/// Runs `hpf recover`.
pub fn recover(options: &Recover, common: &Common) -> Result<Outcome, Failure> {
    let source = &options.log;
    let default = beside(source);
    let target = common.out.as_deref().unwrap_or(&default);
    let is_source =
        target.canonicalize().is_ok_and(|target| source.canonicalize().is_ok_and(|source| source == target));
    if is_source {
        return Err(in_file(target)("this is the log itself, which is never written: name another file with --out"));
    }
    let recovered = log::recover(&read_bytes(source)?).map_err(in_file(source))?;
    deliver(common, Some(&default), &recovered.bytes, |file| {
        let object = json!({
            "format": "hpf-recover", "version": 1, "log": source.display().to_string(), "file": file.display().to_string(),
            "ending": recovered.ending.word(), "messages": recovered.messages, "chunks": recovered.chunks,
            "messages_of_cut_chunk": recovered.from_cut_chunk, "start_s": seconds(recovered.times.map(|times| times.0)),
            "end_s": seconds(recovered.times.map(|times| times.1)), "last_update": recovered.last_update,
            "attachments": recovered.attachments, "metadata": recovered.metadata,
            "lost": { "damaged_records": recovered.damaged, "messages_without_channel": recovered.orphans,
                "unreadable_bytes": recovered.strange_bytes },
        });
        Some((text(source, file, &recovered), object))
    })
}

/// `log.recovered.mcap` beside `log.mcap` or `log.mcap.partial`.
fn beside(source: &Path) -> PathBuf {
    let name = source.file_name().map(|name| name.to_string_lossy()).unwrap_or_default();
    let stem = name.strip_suffix(".partial").unwrap_or(&name);
    source.with_file_name(format!("{}.recovered.mcap", stem.strip_suffix(".mcap").unwrap_or(stem)))
}

fn seconds(nanoseconds: Option<u64>) -> Option<f64> {
    nanoseconds.map(|nanoseconds| nanoseconds as f64 / 1e9)
}

fn text(source: &Path, file: &Path, recovered: &Recovered) -> String {
    let mut text = format!("{}: {}\n", source.display(), recovered.ending);
    let Recovered { messages, chunks, from_cut_chunk, .. } = recovered;
    let _ = write!(text, "kept     {messages} messages, of {chunks} whole chunks");
    if *from_cut_chunk > 0 {
        let _ = write!(text, " and {from_cut_chunk} of a cut one");
    }
    if let (Some(start), Some(end)) = (seconds(recovered.times.map(|t| t.0)), seconds(recovered.times.map(|t| t.1))) {
        let _ = write!(text, ", from {start} s to {end} s");
    }
    if let Some(update) = recovered.last_update {
        let _ = write!(text, ", up to update {update}");
    }
    let none_or = |names: &[String]| if names.is_empty() { "none".to_owned() } else { names.join(", ") };
    let _ = write!(
        text,
        "\n         metadata: {}; attachments: {}\n",
        none_or(&recovered.metadata),
        none_or(&recovered.attachments)
    );
    let lost = [
        (recovered.damaged, "chunks and attachments with a wrong checksum"),
        (recovered.orphans, "messages that nothing says what they are"),
        (recovered.strange_bytes, "bytes that are no whole record"),
    ];
    let lost: Vec<String> =
        lost.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    let lost = match (lost.is_empty(), &recovered.ending) {
        (true, Ending::Complete) => "nothing: the log was whole".into(),
        (true, _) => "what stood behind the end of the file".into(),
        (false, _) => lost.join("; "),
    };
    let _ = writeln!(text, "lost     {lost}\nwritten  {}, {} bytes", file.display(), recovered.bytes.len());
    text
}
