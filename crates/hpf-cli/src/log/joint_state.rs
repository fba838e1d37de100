//! `sensor_msgs/msg/JointState` in CDR, which Rerun and PlotJuggler plot by themselves.

use cdr::{CdrLe, Infinite};
use serde::Serialize;

/// Name of the message.
pub const NAME: &str = "sensor_msgs/msg/JointState";

/// The definition, and after each ruler that of a message it uses.
pub const DEFINITION: &str = "\
std_msgs/Header header

string[] name
float64[] position
float64[] velocity
float64[] effort
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";

/// Every axis at one instant: position [m or rad], velocity [m/s or rad/s], effort [N or N m].
#[derive(Serialize)]
pub struct JointState<'a> {
    pub header: Header,
    pub name: &'a [&'a str],
    pub position: &'a [f64],
    pub velocity: &'a [f64],
    pub effort: &'a [f64],
}

/// `std_msgs/msg/Header`
#[derive(Serialize)]
pub struct Header {
    pub sec: i32,
    pub nanosec: u32,
    pub frame_id: &'static str,
}

impl JointState<'_> {
    /// The message, little-endian, with its encapsulation header.
    pub fn to_cdr(&self) -> Vec<u8> {
        cdr::serialize::<_, _, CdrLe>(self, Infinite).expect("texts and numbers always have a CDR form")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_as_cdr_wants() {
        let header = Header { sec: 1, nanosec: 2, frame_id: "" };
        let message = JointState { header, name: &["y"], position: &[0.5], velocity: &[], effort: &[] };
        let expected: [&[u8]; 10] = [
            &[0, 1, 0, 0],                            // little-endian
            &[1, 0, 0, 0],                            // sec
            &[2, 0, 0, 0],                            // nanosec
            &[1, 0, 0, 0, 0, 0, 0, 0],                // frame_id: one byte, the end; filled up to 4
            &[1, 0, 0, 0, 2, 0, 0, 0, b'y', 0, 0, 0], // name: one, of two bytes; filled up to 4
            &[1, 0, 0, 0],                            // position: one, which begins at a multiple of 8
            &0.5_f64.to_le_bytes(),
            &[0, 0, 0, 0],
            &[0, 0, 0, 0],
            &[],
        ];
        assert_eq!(message.to_cdr(), expected.concat());
    }
}
