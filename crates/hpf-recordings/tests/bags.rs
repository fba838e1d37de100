//! Bags of ROS 2 as MCAP: messages of every type that is read, packed in every way.

use std::collections::BTreeMap;
use std::io::Cursor;

use cdr::{CdrBe, CdrLe, Infinite};
use hpf_recordings::{Mapping, Read, read};
use hpf_sim::task::Unit;
use mcap::records::MessageHeader;
use mcap::{Compression, WriteOptions};
use serde::Serialize;

/// Messages of a bag, at 100 Hz from this time on [ns].
const COUNT: u32 = 30;
const START: u64 = 1_700_000_000_000_000_000;

/// sec, nanosec, frame.
type Header = (i32, u32, String);

fn header(i: u32) -> Header {
    let time = START + 10_000_000 * u64::from(i);
    ((time / 1_000_000_000) as i32, (time % 1_000_000_000) as u32, "base".into())
}

fn x(i: u32) -> f64 {
    let u = f64::from(i) / f64::from(COUNT - 1);
    0.3 * u * u * (3.0 - 2.0 * u)
}

fn pose(i: u32) -> ([f64; 3], [f64; 4]) {
    ([x(i), 0.1, -x(i)], [0.0, 0.0, 0.0, 1.0])
}

struct Bag {
    options: WriteOptions,
    encoding: &'static str,
    is_big: bool,
}

impl Default for Bag {
    fn default() -> Self {
        Self { options: WriteOptions::default(), encoding: "ros2msg", is_big: false }
    }
}

/// A topic: its name, its type, its messages.
type Topic = (&'static str, &'static str, Vec<Vec<u8>>);

impl Bag {
    fn messages<M: Serialize>(&self, make: impl Fn(u32) -> M) -> Vec<Vec<u8>> {
        let bytes = |message: &M| {
            if self.is_big {
                cdr::serialize::<_, _, CdrBe>(message, Infinite).unwrap()
            } else {
                cdr::serialize::<_, _, CdrLe>(message, Infinite).unwrap()
            }
        };
        (0..COUNT).map(|i| bytes(&make(i))).collect()
    }

    /// A file of `topics`; messages arrive in bursts of five.
    fn write(&self, topics: &[Topic]) -> Vec<u8> {
        let mut writer = self.options.clone().profile("ros2").create(Cursor::new(Vec::new())).unwrap();
        for (topic, kind, messages) in topics {
            let schema = writer.add_schema(kind, self.encoding, b"").unwrap();
            let channel_id = writer.add_channel(schema, topic, "cdr", &BTreeMap::new()).unwrap();
            for (i, data) in messages.iter().enumerate() {
                let log_time = START + 50_000_000 * (i as u64 / 5) + i as u64;
                let header = MessageHeader { channel_id, sequence: i as u32, log_time, publish_time: log_time };
                writer.write_to_known_channel(&header, data).unwrap();
            }
        }
        writer.finish().unwrap();
        writer.into_inner().into_inner()
    }
}

#[track_caller]
fn is_motion(read: &Read) {
    let recording = &read.recording;
    assert_eq!(recording.time.len(), COUNT as usize);
    for i in 0..COUNT {
        // The header's time: arrivals come five at once.
        assert!((recording.time[i as usize] - 0.01 * f64::from(i)).abs() < 1e-9, "{:?}", recording.time);
        assert_eq!(recording.axes[0].position[i as usize], x(i));
    }
}

fn plain(bytes: &[u8]) -> Read {
    read(bytes, &Mapping::default()).unwrap_or_else(|refusal| panic!("{refusal:?}"))
}

#[test]
fn poses_are_read_however_the_file_is_packed() {
    for compression in [None, Some(Compression::Zstd), Some(Compression::Lz4)] {
        for (is_chunked, encoding, is_big) in [(true, "ros2msg", false), (false, "ros2idl", true)] {
            let options = WriteOptions::default().compression(compression).use_chunks(is_chunked);
            let bag = Bag { options, encoding, is_big };
            let bytes =
                bag.write(&[("/pose", "geometry_msgs/msg/PoseStamped", bag.messages(|i| (header(i), pose(i))))]);
            let read = plain(&bytes);
            is_motion(&read);
            assert_eq!(read.recording.axes.iter().map(|axis| axis.name.as_str()).collect::<Vec<_>>(), ["x", "y", "z"]);
            assert!(read.notes.iter().any(|note| note.contains("not read: qx")), "{:?}", read.notes);
        }
    }
}

#[test]
fn every_type_with_positions_is_read() {
    let bag = Bag::default();
    let twist = ([0.0; 3], [0.0; 3]);
    let child = || "tool".to_owned();
    let types: Vec<Topic> = vec![
        ("/p", "geometry_msgs/msg/PointStamped", bag.messages(|i| (header(i), pose(i).0))),
        ("/t", "geometry_msgs/msg/TransformStamped", bag.messages(|i| (header(i), child(), pose(i)))),
        ("/tf", "tf2_msgs/msg/TFMessage", bag.messages(|i| vec![(header(i), child(), pose(i))])),
        ("/o", "nav_msgs/msg/Odometry", bag.messages(|i| (header(i), child(), pose(i), [0.0; 16], [0.0; 20], twist))),
    ];
    for topic in types {
        is_motion(&plain(&bag.write(&[topic])));
    }
    let joints = bag.messages(|i| (header(i), vec!["j1", "j2"], vec![x(i), 0.5], vec![0.0, 0.0], Vec::<f64>::new()));
    let read = plain(&bag.write(&[("/joint_states", "sensor_msgs/msg/JointState", joints)]));
    is_motion(&read);
    assert_eq!((read.recording.axes[1].name.as_str(), read.recording.axes[1].unit), ("j2", Unit::Rad));
    // A pose without header has the time of arrival: bursts of a sixth of the recording are too long to be spread.
    let poses = bag.write(&[("/pose", "geometry_msgs/msg/Pose", bag.messages(pose))]);
    let refusal = hpf_recordings::read(&poses, &Mapping::default()).unwrap_err();
    assert!(refusal.mistakes[0].message.contains("read the rows as even with --sample-rate HZ"), "{refusal:?}");
    let read = hpf_recordings::read(&poses, &Mapping { sample_rate: Some(100.0), ..Mapping::default() }).unwrap();
    is_motion(&read);
    assert!(read.notes.iter().any(|note| note.contains("Pose has no header")), "{:?}", read.notes);
}

#[test]
fn one_topic_of_several_is_named_and_a_force_is_brought_to_its_times() {
    let bag = Bag::default();
    let wrench = |i| (header(i), [2.0 * f64::from(i), 0.0, 0.0], [0.0; 3]);
    let topics = [
        ("/pose", "geometry_msgs/msg/PoseStamped", bag.messages(|i| (header(i), pose(i)))),
        ("/other", "geometry_msgs/msg/PoseStamped", bag.messages(|i| (header(i), pose(0)))),
        ("/wrench", "geometry_msgs/msg/WrenchStamped", bag.messages(wrench)),
        ("/image", "sensor_msgs/msg/Image", vec![vec![0; 100]; 3]),
    ];
    let bytes = bag.write(&topics);
    let refusal = read(&bytes, &Mapping::default()).unwrap_err();
    assert!(refusal.mistakes[0].message.contains("name one with --topic, of /other, /pose"), "{refusal:?}");
    let saw = refusal.saw.unwrap().to_string();
    assert!(saw.contains("/image") && saw.contains("this type is not read"), "{saw}");
    let topic = |name: &str| Mapping { topic: Some(name.into()), ..Mapping::default() };
    is_motion(&read(&bytes, &topic("/pose")).unwrap());
    let options = Mapping { forces: vec!["x=force.x".parse().unwrap()], ..topic("/pose,/wrench") };
    let read = read(&bytes, &options).unwrap();
    is_motion(&read);
    let force = read.recording.axes[0].force.as_ref().unwrap();
    assert!((0..COUNT).all(|i| (force[i as usize] - 2.0 * f64::from(i)).abs() < 1e-5), "{force:?}");
    let refusal = hpf_recordings::read(&bytes, &topic("/nothing")).unwrap_err();
    assert!(refusal.mistakes[0].message.contains("there is no topic `/nothing`"), "{refusal:?}");
}

#[test]
fn two_files_one_behind_the_other_are_read_and_a_cut_one_to_its_end() {
    let bag = Bag { options: WriteOptions::default().use_chunks(false), ..Bag::default() };
    let bytes = bag.write(&[("/pose", "geometry_msgs/msg/PoseStamped", bag.messages(|i| (header(i), pose(i))))]);
    let twice = plain(&[bytes.clone(), bytes.clone()].concat());
    assert!(twice.notes.iter().any(|note| note.contains("2 MCAP files")), "{:?}", twice.notes);
    is_motion(&twice);
    let cut = plain(&bytes[..bytes.len() * 2 / 5]);
    assert!(cut.notes.iter().any(|note| note.contains("the file ends in the middle")), "{:?}", cut.notes);
    // No byte of a bag makes the reader fail in another way than by a refusal.
    for at in (0..bytes.len()).step_by(7) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x55;
        let _ = read(&changed, &Mapping::default());
    }
}
