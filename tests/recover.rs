//! `hpf recover`: what is whole in a log outlives a cut.

use std::fs;
use std::path::Path;

use crate::support::{expect, folder, json, task};

/// Every message of a log: topic, time and bytes. The reader is strict: it checks every checksum.
fn messages(log: &Path) -> Vec<(String, u64, Vec<u8>)> {
    let bytes = fs::read(log).unwrap();
    assert!(mcap::Summary::read(&bytes).unwrap().is_some(), "{} has no summary", log.display());
    let all = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    all.map(|message| (message.channel.topic.clone(), message.log_time, message.data.into_owned())).collect()
}

#[test]
fn a_log_that_was_cut_is_rescued_up_to_the_cut() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    let log = folder.path().join("run/log.mcap");
    let (whole, bytes) = (messages(&log), fs::read(&log).unwrap());
    fs::write(folder.path().join("log.mcap.partial"), &bytes[..bytes.len() * 3 / 5]).unwrap();
    let (stdout, _) = expect(0, folder.path(), &["info", "log.mcap.partial"]);
    assert!(stdout.starts_with("truncated") && stdout.ends_with("next: hpf recover log.mcap.partial\n"), "{stdout}");

    let (stdout, _) = expect(0, folder.path(), &["recover", "log.mcap.partial"]);
    assert!(stdout.contains("metadata: hpf.run; attachments: task.toml, policy.json"), "{stdout}");
    let rescued = messages(&folder.path().join("log.recovered.mcap"));
    assert!(!rescued.is_empty() && rescued.len() < whole.len() && rescued == whole[..rescued.len()]);
    let (stdout, _) = expect(0, folder.path(), &["info", "log.recovered.mcap", "--json"]);
    let info: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(
        (info["ending"].as_str(), info["attachments"][1]["name"].as_str()),
        (Some("complete"), Some("policy.json"))
    );

    let (_, stderr) = expect(2, folder.path(), &["recover", "log.mcap.partial"]);
    assert!(stderr.contains("--force"), "{stderr}");
    let arguments = ["recover", "log.mcap.partial", "--force", "--json", "--out", "there/rescued.mcap"];
    let (stdout, _) = expect(0, folder.path(), &arguments);
    let told: serde_json::Value = serde_json::from_str(&stdout).unwrap();
    assert_eq!(told["messages"].as_u64(), Some(rescued.len() as u64));
    let updates = rescued.iter().filter(|message| message.0 == "/hpf/update").count() as u64;
    assert_eq!(told["last_update"].as_u64(), Some(updates - 1), "updates count from 0");
    assert_eq!(fs::read(log).unwrap(), bytes);
}

#[test]
fn a_whole_log_loses_nothing_and_is_never_written() {
    let folder = folder();
    expect(0, folder.path(), &["learn", &task("reach.toml"), "--quiet", "--out", "run"]);
    let log = folder.path().join("run/log.mcap");
    let bytes = fs::read(&log).unwrap();
    let (stdout, _) = expect(0, folder.path(), &["recover", "run/log.mcap"]);
    assert!(stdout.contains("lost     nothing: the log was whole"), "{stdout}");
    assert_eq!(messages(&folder.path().join("run/log.recovered.mcap")), messages(&log));
    for target in ["run/log.mcap", "run/../run/log.mcap"] {
        let (_, stderr) = expect(2, folder.path(), &["recover", "run/log.mcap", "--force", "--out", target]);
        assert!(stderr.contains("never written"), "{stderr}");
    }
    assert_eq!(fs::read(&log).unwrap(), bytes);
    assert_eq!(json(folder.path().join("run/summary.json"))["task"], "reach");
}

#[test]
fn what_is_no_log_is_said_to_be_none() {
    let folder = folder();
    fs::write(folder.path().join("rubbish.mcap"), b"no log at all, and nothing like one").unwrap();
    let (_, stderr) = expect(2, folder.path(), &["recover", "rubbish.mcap"]);
    assert!(stderr.contains("rubbish.mcap: this is not an MCAP file"), "{stderr}");
    fs::write(folder.path().join("empty.mcap"), mcap::MAGIC).unwrap();
    let (_, stderr) = expect(2, folder.path(), &["recover", "empty.mcap"]);
    assert!(stderr.contains("there is nothing to recover"), "{stderr}");
    expect(2, folder.path(), &["recover", "missing.mcap"]);
    assert!(!folder.path().join("empty.recovered.mcap").exists());
}

#[test]
fn a_small_log_that_unpacks_to_much_is_refused_at_once() {
    // A private record of zeros, in ten chunks of zstd: 2 GB in a few hundred kilobytes.
    let size: u64 = 200 << 20;
    let mut records = vec![0x80];
    records.extend((size - 9).to_le_bytes());
    records.resize(size as usize, 0);
    let crc = hpf_core::packed::crc32(&records);
    let packed = zstd::encode_all(records.as_slice(), 1).unwrap();
    drop(records);
    let mut chunk = [0_u64.to_le_bytes(), 0_u64.to_le_bytes(), size.to_le_bytes()].concat();
    chunk.extend(crc.to_le_bytes());
    chunk.extend(4_u32.to_le_bytes());
    chunk.extend(b"zstd");
    chunk.extend((packed.len() as u64).to_le_bytes());
    chunk.extend(&packed);
    let mut bytes = mcap::MAGIC.to_vec();
    for _ in 0..10 {
        bytes.push(mcap::records::op::CHUNK);
        bytes.extend((chunk.len() as u64).to_le_bytes());
        bytes.extend(&chunk);
    }
    let folder = folder();
    assert!(bytes.len() < 1 << 20, "{}", bytes.len());
    fs::write(folder.path().join("bomb.mcap"), &bytes).unwrap();
    for command in ["info", "recover"] {
        let (_, stderr) = expect(2, folder.path(), &[command, "bomb.mcap"]);
        assert!(stderr.contains("bomb.mcap: its chunks unpack to more than"), "{command}: {stderr}");
    }
    assert!(!folder.path().join("bomb.recovered.mcap").exists());
}
