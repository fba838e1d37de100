//! Messages of ROS 2 that hold positions or forces, from CDR of either byte order.

use serde::Deserialize;
use serde::de::DeserializeOwned;

/// A row of a topic.
pub struct Row {
    /// Time of the header [ns]; `None` for a type without one.
    pub stamp: Option<i64>,
    /// Names and units of the values.
    pub names: Vec<(String, &'static str)>,
    pub values: Vec<f64>,
}

/// The types that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    PoseStamped,
    Pose,
    Point,
    PointStamped,
    TransformStamped,
    TfMessage,
    Odometry,
    WrenchStamped,
    TwistStamped,
    JointState,
    Float64MultiArray,
}

impl Kind {
    /// Whether it holds positions.
    pub fn has_positions(self) -> bool {
        !matches!(self, Self::WrenchStamped | Self::TwistStamped | Self::Float64MultiArray)
    }
}

/// The type of this name, as ros2msg (`geometry_msgs/msg/Pose`) or IDL (`geometry_msgs::msg::Pose`) writes it.
pub fn kind_of(schema: &str) -> Option<Kind> {
    let name = schema.replace("::", "/");
    let (package, name) = (name.split('/').next()?, name.rsplit('/').next()?);
    Some(match (package, name) {
        ("geometry_msgs", "PoseStamped") => Kind::PoseStamped,
        ("geometry_msgs", "Pose") => Kind::Pose,
        ("geometry_msgs", "Point") => Kind::Point,
        ("geometry_msgs", "PointStamped") => Kind::PointStamped,
        ("geometry_msgs", "TransformStamped") => Kind::TransformStamped,
        ("tf2_msgs" | "tf", "TFMessage" | "tfMessage") => Kind::TfMessage,
        ("nav_msgs", "Odometry") => Kind::Odometry,
        ("geometry_msgs", "WrenchStamped") => Kind::WrenchStamped,
        ("geometry_msgs", "TwistStamped") => Kind::TwistStamped,
        ("sensor_msgs", "JointState") => Kind::JointState,
        ("std_msgs", "Float64MultiArray") => Kind::Float64MultiArray,
        _ => return None,
    })
}

#[derive(Deserialize)]
struct Header {
    sec: i32,
    nanosec: u32,
    _frame_id: String,
}

impl Header {
    fn stamp(&self) -> Option<i64> {
        Some(i64::from(self.sec) * 1_000_000_000 + i64::from(self.nanosec))
    }
}

type Vector = [f64; 3];
type Quaternion = [f64; 4];

#[derive(Deserialize)]
struct Pose {
    position: Vector,
    orientation: Quaternion,
}

#[derive(Deserialize)]
struct PoseStamped {
    header: Header,
    pose: Pose,
}

#[derive(Deserialize)]
struct PointStamped {
    header: Header,
    point: Vector,
}

#[derive(Deserialize)]
struct TransformStamped {
    header: Header,
    child_frame_id: String,
    transform: Pose,
}

#[derive(Deserialize)]
struct TfMessage {
    transforms: Vec<TransformStamped>,
}

/// Up to the pose: its covariance and the twist follow.
#[derive(Deserialize)]
struct Odometry {
    header: Header,
    _child_frame_id: String,
    pose: Pose,
}

#[derive(Deserialize)]
struct Pair {
    header: Header,
    first: Vector,
    second: Vector,
}

#[derive(Deserialize)]
struct JointState {
    header: Header,
    name: Vec<String>,
    position: Vec<f64>,
    velocity: Vec<f64>,
    effort: Vec<f64>,
}

#[derive(Deserialize)]
struct Dimension {
    _label: String,
    _size: u32,
    _stride: u32,
}

#[derive(Deserialize)]
struct Float64MultiArray {
    _dim: Vec<Dimension>,
    _data_offset: u32,
    data: Vec<f64>,
}

fn read<T: DeserializeOwned>(data: &[u8]) -> Result<T, String> {
    cdr::deserialize(data).map_err(|error| format!("a message is damaged or of another version: {error}"))
}

/// The rows of a message, each with the frame it is of where a message holds several.
///
/// # Errors
/// Why the bytes are none of this type.
pub fn decode(schema: &str, data: &[u8]) -> Result<Vec<(String, Row)>, String> {
    let kind = kind_of(schema).ok_or("this type is not read")?;
    let one = |row: Row| Ok(vec![(String::new(), row)]);
    match kind {
        Kind::PoseStamped => read(data).and_then(|PoseStamped { header, pose }| one(of_pose(header.stamp(), &pose))),
        Kind::Pose => read(data).and_then(|pose: Pose| one(of_pose(None, &pose))),
        Kind::Point => read(data).and_then(|point: Vector| one(of_vectors(None, [("", "m", point)]))),
        Kind::PointStamped => {
            read(data).and_then(|PointStamped { header, point }| one(of_vectors(header.stamp(), [("", "m", point)])))
        }
        Kind::TransformStamped => read(data).map(|transform| vec![of_transform(transform)]),
        Kind::TfMessage => {
            read(data).map(|message: TfMessage| message.transforms.into_iter().map(of_transform).collect())
        }
        Kind::Odometry => read(data).and_then(|Odometry { header, pose, .. }| one(of_pose(header.stamp(), &pose))),
        Kind::WrenchStamped => read(data).and_then(|Pair { header, first, second }| {
            one(of_vectors(header.stamp(), [("force.", "n", first), ("torque.", "nm", second)]))
        }),
        Kind::TwistStamped => read(data).and_then(|Pair { header, first, second }| {
            one(of_vectors(header.stamp(), [("linear.", "", first), ("angular.", "", second)]))
        }),
        Kind::JointState => read(data).and_then(|message: JointState| of_joints(&message)).and_then(one),
        Kind::Float64MultiArray => read(data).and_then(|Float64MultiArray { data, .. }| {
            let names = (0..data.len()).map(|i| (format!("data[{i}]"), "")).collect();
            one(Row { stamp: None, names, values: data })
        }),
    }
}

fn of_vectors<const N: usize>(stamp: Option<i64>, vectors: [(&str, &'static str, Vector); N]) -> Row {
    let mut row = Row { stamp, names: Vec::new(), values: Vec::new() };
    for (stem, unit, vector) in vectors {
        for (axis, value) in ["x", "y", "z"].into_iter().zip(vector) {
            row.names.push((format!("{stem}{axis}"), unit));
            row.values.push(value);
        }
    }
    row
}

fn of_pose(stamp: Option<i64>, pose: &Pose) -> Row {
    let mut row = of_vectors(stamp, [("", "m", pose.position)]);
    for (name, value) in ["qx", "qy", "qz", "qw"].into_iter().zip(pose.orientation) {
        row.names.push((name.into(), ""));
        row.values.push(value);
    }
    row
}

fn of_transform(message: TransformStamped) -> (String, Row) {
    (message.child_frame_id, of_pose(message.header.stamp(), &message.transform))
}

fn of_joints(message: &JointState) -> Result<Row, String> {
    let JointState { header, name, position, velocity, effort } = message;
    let mut row = Row { stamp: header.stamp(), names: Vec::new(), values: Vec::new() };
    for (kind, unit, list) in [("position", "rad", position), ("velocity", "", velocity), ("effort", "", effort)] {
        if list.is_empty() {
            continue;
        }
        if list.len() != name.len() {
            return Err(format!("{} numbers of {kind} for {} joints", list.len(), name.len()));
        }
        row.names.extend(name.iter().map(|joint| (format!("{joint}.{kind}"), unit)));
        row.values.extend(list);
    }
    Ok(row)
}
