//! Messages of ROS 2 in CDR, with their definitions.
//!
//! ```text
//! bytes    0 1 0 0, little-endian; then the fields in their order, numbers at multiples of their size from there
//! text     its length with the terminating zero byte in 4 bytes, its bytes, a zero byte
//! list     its count in 4 bytes, its elements
//! ```

use cdr::{CdrLe, Infinite};
use foxglove::Schema;
use foxglove::messages::{Pose, Quaternion, Vector3};
use serde::Serialize;

/// A message: its name, and its definition with those it uses by name.
pub type Kind = (&'static str, &'static str, &'static [&'static str]);

pub const JOINT_STATE: Kind = (
    "sensor_msgs/msg/JointState",
    "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\nfloat64[] effort\n",
    &["std_msgs/Header", "builtin_interfaces/Time"],
);
pub const POSE_STAMPED: Kind = (
    "geometry_msgs/msg/PoseStamped",
    "std_msgs/Header header\ngeometry_msgs/Pose pose\n",
    &[
        "std_msgs/Header",
        "builtin_interfaces/Time",
        "geometry_msgs/Pose",
        "geometry_msgs/Point",
        "geometry_msgs/Quaternion",
    ],
);
pub const WRENCH_STAMPED: Kind = (
    "geometry_msgs/msg/WrenchStamped",
    "std_msgs/Header header\ngeometry_msgs/Wrench wrench\n",
    &["std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Wrench", "geometry_msgs/Vector3"],
);
pub const TF_MESSAGE: Kind = (
    "tf2_msgs/msg/TFMessage",
    "geometry_msgs/TransformStamped[] transforms\n",
    &[
        "geometry_msgs/TransformStamped",
        "std_msgs/Header",
        "builtin_interfaces/Time",
        "geometry_msgs/Transform",
        "geometry_msgs/Vector3",
        "geometry_msgs/Quaternion",
    ],
);
pub const FLOAT64_MULTI_ARRAY: Kind = (
    "std_msgs/msg/Float64MultiArray",
    "std_msgs/MultiArrayLayout layout\nfloat64[] data\n",
    &["std_msgs/MultiArrayLayout", "std_msgs/MultiArrayDimension"],
);

/// The definitions that others use.
const PARTS: [(&str, &str); 11] = [
    ("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n"),
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("geometry_msgs/Pose", "geometry_msgs/Point position\ngeometry_msgs/Quaternion orientation\n"),
    ("geometry_msgs/Point", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Vector3", "float64 x\nfloat64 y\nfloat64 z\n"),
    ("geometry_msgs/Quaternion", "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n"),
    ("geometry_msgs/Wrench", "geometry_msgs/Vector3 force\ngeometry_msgs/Vector3 torque\n"),
    (
        "geometry_msgs/TransformStamped",
        "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform\n",
    ),
    ("geometry_msgs/Transform", "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation\n"),
    ("std_msgs/MultiArrayLayout", "std_msgs/MultiArrayDimension[] dim\nuint32 data_offset\n"),
    ("std_msgs/MultiArrayDimension", "string label\nuint32 size\nuint32 stride\n"),
];

/// The definition of a message, and after each ruler that of one it uses.
pub fn schema((name, definition, parts): Kind) -> Schema {
    let mut text = definition.to_owned();
    for part in parts {
        let (_, definition) = PARTS.iter().find(|(name, _)| name == part).expect("every part used is defined");
        text += &format!("{:=<80}\nMSG: {part}\n{definition}", "");
    }
    Schema::new(name, "ros2msg", text.into_bytes())
}

/// A message, little-endian, with its encapsulation header.
pub fn to_cdr(message: &impl Serialize) -> Vec<u8> {
    cdr::serialize::<_, _, CdrLe>(message, Infinite).expect("texts and numbers always have a CDR form")
}

/// `std_msgs/msg/Header`
#[derive(Clone, Copy, Serialize)]
pub struct Header {
    pub sec: i32,
    pub nanosec: u32,
    pub frame_id: &'static str,
}

impl Header {
    /// The time in ns and the frame of a message.
    pub fn new(nanoseconds: u64, frame_id: &'static str) -> Self {
        let sec = i32::try_from(nanoseconds / 1_000_000_000).unwrap_or(i32::MAX);
        Self { sec, nanosec: (nanoseconds % 1_000_000_000) as u32, frame_id }
    }
}

/// Every axis at one instant: position [m or rad], velocity [m/s or rad/s], effort [N or N m].
#[derive(Serialize)]
pub struct JointState<'a> {
    pub header: Header,
    pub name: &'a [&'a str],
    pub position: &'a [f64],
    pub velocity: &'a [f64],
    pub effort: &'a [f64],
}

/// `geometry_msgs/msg/PoseStamped`: position [m], then the quaternion x, y, z, w.
#[derive(Serialize)]
pub struct PoseStamped {
    pub header: Header,
    pub position: [f64; 3],
    pub orientation: [f64; 4],
}

/// `geometry_msgs/msg/WrenchStamped`: force [N], torque [N m].
#[derive(Serialize)]
pub struct WrenchStamped {
    pub header: Header,
    pub force: [f64; 3],
    pub torque: [f64; 3],
}

/// `geometry_msgs/msg/TransformStamped`: translation [m], then the quaternion x, y, z, w.
#[derive(Serialize)]
pub struct TransformStamped {
    pub header: Header,
    pub child_frame_id: &'static str,
    pub translation: [f64; 3],
    pub rotation: [f64; 4],
}

/// `tf2_msgs/msg/TFMessage`
#[derive(Serialize)]
pub struct TfMessage {
    pub transforms: Vec<TransformStamped>,
}

/// `std_msgs/msg/Float64MultiArray`
#[derive(Serialize)]
pub struct Float64MultiArray<'a> {
    pub dim: Vec<Dimension>,
    pub data_offset: u32,
    pub data: &'a [f64],
}

/// `std_msgs/msg/MultiArrayDimension`: the stride is the product of this size and those after it.
#[derive(Serialize)]
pub struct Dimension {
    pub label: String,
    pub size: u32,
    pub stride: u32,
}

/// Position [m] and quaternion of a pose.
pub fn numbers(pose: &Pose) -> ([f64; 3], [f64; 4]) {
    let Vector3 { x, y, z } = pose.position.unwrap_or_default();
    let turn = pose.orientation.unwrap_or(Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 });
    ([x, y, z], [turn.x, turn.y, turn.z, turn.w])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_as_cdr_wants() {
        let header = Header::new(1_000_000_002, "");
        let message = JointState { header, name: &["y"], position: &[0.5], velocity: &[], effort: &[] };
        let expected: [&[u8]; 9] = [
            &[0, 1, 0, 0],                            // little-endian
            &[1, 0, 0, 0],                            // sec
            &[2, 0, 0, 0],                            // nanosec
            &[1, 0, 0, 0, 0, 0, 0, 0],                // frame_id: one byte, the end; filled up to 4
            &[1, 0, 0, 0, 2, 0, 0, 0, b'y', 0, 0, 0], // name: one, of two bytes; filled up to 4
            &[1, 0, 0, 0],                            // position: one, which begins at a multiple of 8
            &0.5_f64.to_le_bytes(),
            &[0, 0, 0, 0],
            &[0, 0, 0, 0],
        ];
        assert_eq!(to_cdr(&message), expected.concat());
    }

    #[test]
    fn every_message_is_defined_to_its_last_part() {
        for kind in [JOINT_STATE, POSE_STAMPED, WRENCH_STAMPED, TF_MESSAGE, FLOAT64_MULTI_ARRAY] {
            let schema = schema(kind);
            let text = String::from_utf8(schema.data.to_vec()).unwrap();
            let defined: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("MSG: ")).collect();
            assert_eq!(defined, kind.2, "{}", schema.name);
            for line in text.lines().filter(|line| line.contains('/') && !line.starts_with("MSG: ")) {
                let used = line.split(' ').next().unwrap().trim_end_matches("[]");
                assert!(defined.contains(&used), "{}: {used} is not defined", schema.name);
            }
        }
    }
}
