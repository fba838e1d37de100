//! Messages of ROS 2 that hold positions or forces, from CDR of either byte order.

use super::cdr::{Cdr, Damaged};

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

type Vector = [f64; 3];

/// Position and quaternion.
type Pose = (Vector, [f64; 4]);

/// Why a message is not read.
const DAMAGED: &str = "a message is damaged or of another version";

impl From<Damaged> for String {
    fn from(_: Damaged) -> Self {
        DAMAGED.into()
    }
}

/// The time of a header [ns].
fn header(cdr: &mut Cdr<'_>) -> Result<Option<i64>, Damaged> {
    let (seconds, nanoseconds) = (cdr.i32()?, cdr.u32()?);
    cdr.text()?;
    Ok(Some(i64::from(seconds) * 1_000_000_000 + i64::from(nanoseconds)))
}

fn pose(cdr: &mut Cdr<'_>) -> Result<Pose, Damaged> {
    Ok((cdr.numbers()?, cdr.numbers()?))
}

/// A transform and the frame that it moves.
fn transform(cdr: &mut Cdr<'_>) -> Result<(String, Row), Damaged> {
    let stamp = header(cdr)?;
    let child = cdr.text()?;
    Ok((child, of_pose(stamp, pose(cdr)?)))
}

/// The rows of a message, each with the frame it is of where a message holds several.
///
/// # Errors
/// Why the bytes are none of this type.
pub fn decode(schema: &str, data: &[u8]) -> Result<Vec<(String, Row)>, String> {
    let kind = kind_of(schema).ok_or("this type is not read")?;
    let cdr = &mut Cdr::new(data)?;
    let row = match kind {
        Kind::PoseStamped => of_pose(header(cdr)?, pose(cdr)?),
        Kind::Pose => of_pose(None, pose(cdr)?),
        Kind::Point => of_vectors(None, [("", "m", cdr.numbers()?)]),
        Kind::PointStamped => of_vectors(header(cdr)?, [("", "m", cdr.numbers()?)]),
        Kind::TransformStamped => return Ok(vec![transform(cdr)?]),
        Kind::TfMessage => {
            // Each takes more bytes than it says: a count that cannot be ends at the end of the message.
            let count = cdr.u32()?;
            return Ok((0..count).map(|_| transform(cdr)).collect::<Result<_, _>>()?);
        }
        Kind::Odometry => {
            let stamp = header(cdr)?;
            cdr.text()?;
            // Covariances and the twist follow.
            of_pose(stamp, pose(cdr)?)
        }
        Kind::WrenchStamped => {
            of_vectors(header(cdr)?, [("force.", "n", cdr.numbers()?), ("torque.", "nm", cdr.numbers()?)])
        }
        Kind::TwistStamped => {
            of_vectors(header(cdr)?, [("linear.", "", cdr.numbers()?), ("angular.", "", cdr.numbers()?)])
        }
        Kind::JointState => {
            let stamp = header(cdr)?;
            let count = cdr.u32()?;
            let names = (0..count).map(|_| cdr.text()).collect::<Result<Vec<_>, _>>()?;
            let lists = [("position", "rad"), ("velocity", ""), ("effort", "")];
            let mut row = Row { stamp, names: Vec::new(), values: Vec::new() };
            for (kind, unit) in lists {
                let list = cdr.list()?;
                if list.is_empty() {
                    continue;
                }
                if list.len() != names.len() {
                    return Err(format!("{} numbers of {kind} for {} joints", list.len(), names.len()));
                }
                row.names.extend(names.iter().map(|joint| (format!("{joint}.{kind}"), unit)));
                row.values.extend(list);
            }
            row
        }
        Kind::Float64MultiArray => {
            for _ in 0..cdr.u32()? {
                cdr.text()?;
                cdr.u32()?;
                cdr.u32()?;
            }
            cdr.u32()?;
            let values = cdr.list()?;
            let names = (0..values.len()).map(|i| (format!("data[{i}]"), "")).collect();
            Row { stamp: None, names, values }
        }
    };
    Ok(vec![(String::new(), row)])
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

fn of_pose(stamp: Option<i64>, (position, orientation): Pose) -> Row {
    let mut row = of_vectors(stamp, [("", "m", position)]);
    for (name, value) in ["qx", "qy", "qz", "qw"].into_iter().zip(orientation) {
        row.names.push((name.into(), ""));
        row.values.push(value);
    }
    row
}
