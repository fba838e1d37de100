//! Where the axes of a task lie in space, so that a motion of any axes can be seen.
//!
//! World: x to the right, y away, z up [m].
//! - The deflection of a cantilever points down, so its axis takes -z; the way along the beam takes x, unless an axis
//!   is named x: the tool slides along a beam that bends down.
//! - Linear axes named x, y, z take that coordinate; the others fill the free ones in order. A fourth is not shown.
//! - Rotary axes named roll, pitch, yaw (rx, ry, rz) turn about x, y, z, in this order about the fixed axes of the
//!   world. Others are not shown.

use foxglove::messages::{Pose, Quaternion, Vector3};
use hpf_sim::environment::Contact;
use hpf_sim::task::{Task, Unit};

const COORDINATES: [&str; 3] = ["x", "y", "z"];
const ROTATIONS: [[&str; 2]; 3] = [["roll", "rx"], ["pitch", "ry"], ["yaw", "rz"]];

/// Where one axis lies.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    /// Along a coordinate.
    Along(usize),
    /// Against a coordinate.
    Against(usize),
    /// About a coordinate.
    About(usize),
    /// Nowhere.
    Hidden,
}

/// Where the axes of a task lie.
#[derive(Clone, Debug)]
pub struct Space {
    axes: Vec<Place>,
    travel: bool,
}

impl Space {
    pub fn new(task: &Task) -> Self {
        let pressing = match &task.contact {
            Some(Contact::Cantilever(beam)) => Some(beam.axis.as_str()),
            _ => None,
        };
        let axes: Vec<_> = task.axis.iter().map(|axis| (axis.name.as_str(), axis.unit)).collect();
        let (axes, travel) = places(&axes, pressing);
        Self { axes, travel }
    }

    /// A vector with one component per axis, in space; rotary axes leave it alone.
    pub fn vector(&self, of_axis: impl Fn(usize) -> f64) -> [f64; 3] {
        let mut vector = [0.0; 3];
        for (a, place) in self.axes.iter().enumerate() {
            match *place {
                Place::Along(c) => vector[c] = of_axis(a),
                Place::Against(c) => vector[c] = -of_axis(a),
                _ => {}
            }
        }
        vector
    }

    /// A torque with one component per rotary axis, about the coordinates.
    pub fn torque(&self, of_axis: impl Fn(usize) -> f64) -> [f64; 3] {
        let mut torque = [0.0; 3];
        for (a, place) in self.axes.iter().enumerate() {
            if let Place::About(c) = *place {
                torque[c] = of_axis(a);
            }
        }
        torque
    }

    /// A position with one number per axis, `travel` [m] along the contact.
    pub fn position(&self, of_axis: impl Fn(usize) -> f64, travel: f64) -> [f64; 3] {
        let mut position = self.vector(of_axis);
        if self.travel {
            position[0] = travel;
        }
        position
    }

    /// A pose with one number per axis, `travel` [m] along the contact.
    pub fn pose(&self, of_axis: impl Fn(usize) -> f64, travel: f64) -> Pose {
        let mut half = [0.0; 3];
        for (a, place) in self.axes.iter().enumerate() {
            if let Place::About(c) = *place {
                half[c] = 0.5 * of_axis(a);
            }
        }
        let [(sx, cx), (sy, cy), (sz, cz)] = half.map(f64::sin_cos);
        let orientation = Quaternion {
            x: sx * cy * cz - cx * sy * sz,
            y: cx * sy * cz + sx * cy * sz,
            z: cx * cy * sz - sx * sy * cz,
            w: cx * cy * cz + sx * sy * sz,
        };
        Pose { position: Some(vector3(self.position(of_axis, travel))), orientation: Some(orientation) }
    }

    /// For each coordinate, the axis that lies along it.
    pub fn axis_along(&self) -> [Option<usize>; 3] {
        [0, 1, 2].map(|c| self.axes.iter().position(|&place| place == Place::Along(c) || place == Place::Against(c)))
    }
}

/// Where axes with these names and units lie, and whether the way along a cantilever that the axis `pressing` presses
/// takes x.
fn places(axes: &[(&str, Unit)], pressing: Option<&str>) -> (Vec<Place>, bool) {
    let mut places = vec![Place::Hidden; axes.len()];
    let mut free = [true; 3];
    let is_linear = |a: usize| axes[a].1 == Unit::M;
    let beam = (0..axes.len()).find(|&a| is_linear(a) && Some(axes[a].0) == pressing);
    if let Some(a) = beam {
        places[a] = Place::Against(2);
        free[2] = false;
    }
    let others = || (0..axes.len()).filter(|&a| Some(a) != beam);
    let mut travel = pressing.is_some();
    for a in others() {
        if let Some(c) = COORDINATES.iter().position(|name| *name == axes[a].0)
            && is_linear(a)
            && free[c]
        {
            places[a] = Place::Along(c);
            free[c] = false;
            travel &= c != 0;
        } else if let Some(c) = ROTATIONS.iter().position(|names| names.contains(&axes[a].0))
            && !is_linear(a)
        {
            places[a] = Place::About(c);
        }
    }
    free[0] &= !travel;
    for a in others() {
        if let Some(c) = free.iter().position(|free| *free)
            && is_linear(a)
            && places[a] == Place::Hidden
        {
            places[a] = Place::Along(c);
            free[c] = false;
        }
    }
    (places, travel)
}

pub fn vector3([x, y, z]: [f64; 3]) -> Vector3 {
    Vector3 { x, y, z }
}

#[cfg(test)]
mod tests {
    use super::Place::{About, Against, Along, Hidden};
    use super::*;

    #[test]
    fn named_axes_take_their_coordinate_and_others_the_free_ones() {
        let linear = |names: &[&'static str]| -> Vec<_> { names.iter().map(|name| (*name, Unit::M)).collect() };
        assert_eq!(places(&linear(&["x", "y"]), None).0, [Along(0), Along(1)]);
        assert_eq!(places(&linear(&["z", "x"]), None).0, [Along(2), Along(0)]);
        assert_eq!(places(&linear(&["press", "x", "slide"]), None).0, [Along(1), Along(0), Along(2)]);
        assert_eq!(places(&linear(&["a", "b", "c", "d"]), None).0, [Along(0), Along(1), Along(2), Hidden]);
    }

    #[test]
    fn rotary_axes_turn_by_their_names() {
        let axes = [("yaw", Unit::Rad), ("rx", Unit::Rad), ("x", Unit::Rad), ("q", Unit::M)];
        assert_eq!(places(&axes, None).0, [About(2), About(0), Hidden, Along(0)]);
        let space = Space { axes: vec![About(0), About(1), About(2)], travel: false };
        // A quarter turn about x, then one about z, takes y to z, and there it stays.
        let quarter = core::f64::consts::FRAC_PI_2;
        let turn = space.pose(|a| [quarter, 0.0, quarter][a], 0.0).orientation.unwrap();
        let [x, y, z, w] = [turn.x, turn.y, turn.z, turn.w];
        let of_y = [2.0 * (x * y - w * z), w * w - x * x + y * y - z * z, 2.0 * (y * z + w * x)];
        for (found, expected) in of_y.into_iter().zip([0.0, 0.0, 1.0]) {
            assert!((found - expected).abs() < 1e-15, "{of_y:?}");
        }
    }

    #[test]
    fn a_beam_bends_down_and_the_tool_slides_along_it() {
        let axes = [("y", Unit::M), ("z", Unit::M)];
        assert_eq!(places(&axes[..1], Some("y")), (vec![Against(2)], true));
        assert_eq!(places(&axes, Some("y")), (vec![Against(2), Along(1)], true), "z is taken, x is the way");
        assert_eq!(places(&[("x", Unit::M), ("y", Unit::M)], Some("y")), (vec![Along(0), Against(2)], false));
        assert_eq!(places(&[("x", Unit::M)], Some("x")), (vec![Against(2)], true));
        let space = Space { axes: vec![Against(2)], travel: true };
        assert_eq!(space.position(|_| 0.03, 0.8), [0.8, 0.0, -0.03]);
    }
}
