//! The motion of a run as a bag of ROS 2 messages: MCAP with the profile `ros2`, every message in CDR, so that
//! `ros2 bag play`, RViz and PlotJuggler take it as it is.

use std::collections::BTreeMap;
use std::io::Cursor;

use hpf_sim::task::Unit;
use mcap::records::MessageHeader;
use mcap::{McapError, Writer};
use serde::Serialize;

use super::motion::Motion;
use super::ros2::{
    self, Dimension, Float64MultiArray, Header, Kind, PoseStamped, TfMessage, TransformStamped, WrenchStamped,
};
use super::{WORLD, nanoseconds, options};
use crate::results::Run;

/// What is in a bag: topics and their messages, each with one message per step.
const TOPICS: [(&str, Kind); 6] = [
    ("/tool/pose", ros2::POSE_STAMPED),
    ("/reference/pose", ros2::POSE_STAMPED),
    ("/tool/wrench", ros2::WRENCH_STAMPED),
    ("/joint_states", ros2::JOINT_STATE),
    ("/gains", ros2::FLOAT64_MULTI_ARRAY),
    ("/tf", ros2::TF_MESSAGE),
];

/// What `ros2 bag record` writes of a publisher with the usual settings: keep the last 10, reliable, volatile.
const QUALITY: &str = "\
- history: 1
  depth: 10
  reliability: 1
  durability: 2
  deadline:
    sec: 9223372036
    nsec: 854775807
  lifespan:
    sec: 9223372036
    nsec: 854775807
  liveliness: 1
  liveliness_lease_duration:
    sec: 9223372036
    nsec: 854775807
  avoid_ros_namespace_conventions: false
";

/// The bag of a run and the number of its messages.
///
/// # Errors
/// What the writer says.
pub fn bag(run: &Run) -> Result<(Vec<u8>, usize), McapError> {
    let motion = Motion::new(run);
    let mut writer = options().profile("ros2").create(Cursor::new(Vec::new()))?;
    let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), QUALITY.to_owned())]);
    let mut channels = Vec::new();
    for (topic, kind) in TOPICS {
        let schema = ros2::schema(kind);
        let schema = writer.add_schema(&schema.name, &schema.encoding, &schema.data)?;
        channels.push(writer.add_channel(schema, topic, "cdr", &metadata)?);
    }
    let samples = motion.trace.time.len();
    for (i, &time) in motion.trace.time.iter().enumerate() {
        let time = nanoseconds(time);
        let mut bag = Sample { writer: &mut writer, channels: channels.iter(), time };
        let header = Header::new(time, WORLD);
        let [tool, reference] = motion.poses(i).map(|pose| ros2::numbers(&pose));
        for (position, orientation) in [tool, reference] {
            bag.put(&PoseStamped { header, position, orientation })?;
        }
        let (force, torque) = motion.wrench(i);
        bag.put(&WrenchStamped { header, force, torque })?;
        bag.put_bytes(&motion.joints(i, header))?;
        bag.put(&gains(&motion, i, &mut Vec::new()))?;
        let transforms = [("tool", tool), ("reference", reference)].map(|(child_frame_id, (translation, rotation))| {
            TransformStamped { header, child_frame_id, translation, rotation }
        });
        bag.put(&TfMessage { transforms: transforms.into() })?;
    }
    writer.finish()?;
    Ok((writer.into_inner().into_inner(), samples * TOPICS.len()))
}

/// One sample being written, topic by topic.
struct Sample<'a> {
    writer: &'a mut Writer<Cursor<Vec<u8>>>,
    channels: core::slice::Iter<'a, u16>,
    /// [ns]
    time: u64,
}

impl Sample<'_> {
    fn put(&mut self, message: &impl Serialize) -> Result<(), McapError> {
        self.put_bytes(&ros2::to_cdr(message))
    }

    fn put_bytes(&mut self, message: &[u8]) -> Result<(), McapError> {
        let channel_id = *self.channels.next().expect("a sample has one message of each topic");
        let header = MessageHeader { channel_id, sequence: 0, log_time: self.time, publish_time: self.time };
        self.writer.write_to_known_channel(&header, message)
    }
}

/// Stiffness and damping of each axis, labelled with the names of the axes and the units.
fn gains<'d>(motion: &Motion<'_>, i: usize, data: &'d mut Vec<f64>) -> Float64MultiArray<'d> {
    let axes = &motion.trace.axes;
    data.extend(axes.iter().flat_map(|axis| [axis.stiffness[i], axis.damping[i]]));
    let name = |(axis, unit): (&String, Unit)| match unit {
        Unit::M => format!("{axis} [N/m, N s/m]"),
        Unit::Rad => format!("{axis} [N m/rad, N m s/rad]"),
    };
    let names: Vec<String> = motion.task.axis.iter().map(|axis| name((&axis.name, axis.unit))).collect();
    let count = axes.len() as u32;
    let dim = vec![
        Dimension { label: names.join("; "), size: count, stride: 2 * count },
        Dimension { label: "stiffness; damping".into(), size: 2, stride: 2 },
    ];
    Float64MultiArray { dim, data_offset: 0, data }
}
