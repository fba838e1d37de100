//! What a 3D view shows: the path, the places to reach, the force on the tool, how stiffly it is held.
//!
//! An entity replaces the one before it with the same id. Everything is drawn in the world, in a scale of the motion:
//! the arrow is 1 cm per N, at most half the size of the motion; the ellipsoid's radius along an axis is its
//! stiffness, a quarter of the size of the motion for the largest that the task allows.

use foxglove::messages::line_primitive::Type::LineStrip;
use foxglove::messages::{
    ArrowPrimitive, Color, Duration, LinePrimitive, Point3, Pose, Quaternion, SceneEntity, SceneUpdate,
    SpherePrimitive, Timestamp,
};
use hpf_sim::Trace;
use hpf_sim::task::Task;

use super::space::{Space, vector3};

/// Most updates of the moving entities [Hz].
const RATE: f64 = 50.0;
/// Length of the arrow [m/N].
const ARROW_SCALE: f64 = 0.01;
/// Longest arrow, as a share of the size of the motion.
const LONGEST_ARROW: f64 = 0.5;
/// Radius of the ellipsoid at the largest stiffness, as a share of the size of the motion.
const ELLIPSOID_RADIUS: f64 = 0.25;
/// Smallest diameter of the ellipsoid, as a share of the size of the motion.
const THIN: f64 = 0.005;
/// Diameter of targets and of the arrow's head, as a share of the size of the motion.
const MARK: f64 = 0.015;

// Okabe and Ito's colours, which colour-blind people can distinguish.
const LEARNED: Color = Color { r: 0.0, g: 0.447, b: 0.698, a: 1.0 };
const REFERENCE: Color = Color { r: 0.902, g: 0.624, b: 0.0, a: 1.0 };
const TARGET: Color = Color { r: 0.0, g: 0.620, b: 0.451, a: 1.0 };
const FORCE: Color = Color { r: 0.835, g: 0.369, b: 0.0, a: 1.0 };
const STIFFNESS: Color = Color { r: 0.337, g: 0.706, b: 0.914, a: 0.4 };

/// A motion to be shown.
pub struct Scene<'a> {
    task: &'a Task,
    trace: &'a Trace,
    space: &'a Space,
    /// Diagonal of the box around the motion [m].
    size: f64,
    /// The largest stiffness that the task allows [N/m].
    stiffest: f64,
}

impl<'a> Scene<'a> {
    /// The scene of a motion between `corners`, the smallest and the largest of each coordinate [m].
    pub fn new(task: &'a Task, trace: &'a Trace, space: &'a Space, corners: [[f64; 3]; 2]) -> Self {
        let [low, high] = corners;
        let diagonal = (0..3).map(|c| (high[c] - low[c]).powi(2)).sum::<f64>().sqrt();
        let shown = space.axis_along().into_iter().flatten();
        Self {
            task,
            trace,
            space,
            // A motion that stays in its place still needs a scale.
            size: if diagonal > 1e-6 { diagonal } else { 1.0 },
            stiffest: shown.map(|a| task.stiffness.max.of(a)).fold(f64::MIN_POSITIVE, f64::max),
        }
    }

    /// Samples between two updates of the moving entities.
    pub fn stride(&self) -> usize {
        ((self.task.rate / RATE).ceil() as usize).max(1)
    }

    /// What stays: the paths, and what is to be reached.
    pub fn still(&self, learned: &[Pose], reference: &[Pose]) -> SceneUpdate {
        let path = SceneEntity {
            lines: vec![line(learned, LEARNED), line(reference, REFERENCE)],
            ..entity("path", Timestamp::default())
        };
        let goal = self.task.axis.iter().map(|axis| axis.goal).collect();
        let mut targets = vec![(self.task.duration, goal)];
        targets.extend(self.task.via_point.iter().map(|via| (via.time.unwrap_or(0.0), via.position.clone())));
        let travel = |time: f64| {
            self.task.contact.as_ref().map_or(0.0, |contact| contact.travel((time / self.task.duration).min(1.0)))
        };
        let sphere = |(time, position): (f64, Vec<f64>)| {
            let position = self.space.position(|a| position[a], travel(time));
            ellipsoid(position, [MARK * self.size; 3], TARGET)
        };
        let targets = SceneEntity {
            spheres: targets.into_iter().map(sphere).collect(),
            ..entity("targets", Timestamp::default())
        };
        SceneUpdate { entities: vec![path, targets], ..SceneUpdate::default() }
    }

    /// What moves with the tool, at sample `i`: the environment's force on it, and its stiffness.
    pub fn moving(&self, i: usize, position: [f64; 3], timestamp: Timestamp) -> SceneUpdate {
        let force = self.space.vector(|a| environment_force(self.task, self.trace, a, i));
        let force = SceneEntity {
            arrows: arrow(position, force, self.size).into_iter().collect(),
            ..entity("force", timestamp)
        };
        let diameters = self.space.axis_along().map(|axis| {
            let share = axis.map_or(0.0, |a| self.trace.axes[a].stiffness[i] / self.stiffest);
            // A direction without an axis has no stiffness: the ellipsoid is as thin there as can be seen.
            (2.0 * ELLIPSOID_RADIUS * share).max(THIN) * self.size
        });
        let stiffness =
            SceneEntity { spheres: vec![ellipsoid(position, diameters, STIFFNESS)], ..entity("stiffness", timestamp) };
        SceneUpdate { entities: vec![force, stiffness], ..SceneUpdate::default() }
    }
}

/// Force of the environment on the tool along axis `a` [N]: what the admittance sees, without the set-point.
pub(super) fn environment_force(task: &Task, trace: &Trace, a: usize, i: usize) -> f64 {
    let set_point = match (&task.contact, &trace.contact) {
        (Some(contact), Some(signals)) if signals.axis == a => contact.surface(0.0, 0.0).direction * signals.set_point,
        _ => 0.0,
    };
    trace.axes[a].force[i] - set_point
}

fn entity(id: &str, timestamp: Timestamp) -> SceneEntity {
    SceneEntity {
        timestamp: Some(timestamp),
        frame_id: super::WORLD.into(),
        id: id.into(),
        lifetime: Some(Duration::default()),
        ..SceneEntity::default()
    }
}

fn line(path: &[Pose], color: Color) -> LinePrimitive {
    let point = |pose: &Pose| pose.position.map(|p| Point3 { x: p.x, y: p.y, z: p.z });
    LinePrimitive {
        r#type: LineStrip.into(),
        pose: Some(at([0.0; 3])),
        thickness: 2.0,
        scale_invariant: true,
        points: path.iter().filter_map(point).collect(),
        color: Some(color),
        ..LinePrimitive::default()
    }
}

fn ellipsoid(position: [f64; 3], diameters: [f64; 3], color: Color) -> SpherePrimitive {
    SpherePrimitive { pose: Some(at(position)), size: Some(vector3(diameters)), color: Some(color) }
}

/// An arrow from `position` along `force` [N] in a motion of `size` [m]; none where there is no force.
fn arrow(position: [f64; 3], force: [f64; 3], size: f64) -> Option<ArrowPrimitive> {
    let strength = force.iter().map(|f| f * f).sum::<f64>().sqrt();
    let length = (ARROW_SCALE * strength).min(LONGEST_ARROW * size);
    // Below a hundredth of the size it would be a dot.
    (length > 0.01 * size).then(|| ArrowPrimitive {
        pose: Some(Pose { orientation: Some(turn_x_to(force.map(|f| f / strength))), ..at(position) }),
        shaft_length: 0.75 * length,
        shaft_diameter: 0.5 * MARK * size,
        head_length: 0.25 * length,
        head_diameter: MARK * size,
        color: Some(FORCE),
    })
}

fn at(position: [f64; 3]) -> Pose {
    let orientation = Quaternion { x: 0.0, y: 0.0, z: 0.0, w: 1.0 };
    Pose { position: Some(vector3(position)), orientation: Some(orientation) }
}

/// The shortest turn that takes x to the unit vector `direction`.
fn turn_x_to([x, y, z]: [f64; 3]) -> Quaternion {
    let length = (2.0 * (1.0 + x)).max(0.0).sqrt();
    if length < 1e-9 {
        return Quaternion { x: 0.0, y: 0.0, z: 1.0, w: 0.0 };
    }
    Quaternion { x: 0.0, y: -z / length, z: y / length, w: 0.5 * length }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arrow_points_along_its_force_and_stays_in_the_scene() {
        assert_eq!(arrow([0.0; 3], [0.0; 3], 1.0), None, "no force, no arrow");
        let total = |arrow: ArrowPrimitive| arrow.shaft_length + arrow.head_length;
        assert!((total(arrow([0.0; 3], [0.0, 3.0, 4.0], 1.0).unwrap()) - 0.05).abs() < 1e-15, "1 cm per N");
        assert!((total(arrow([0.0; 3], [0.0, 3e6, 4e6], 1.0).unwrap()) - 0.5).abs() < 1e-15, "half of 1 m");
        for direction in [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.6, 0.0, 0.8]] {
            let Quaternion { x, y, z, w } = turn_x_to(direction);
            let of_x = [w * w + x * x - y * y - z * z, 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)];
            for (found, expected) in of_x.into_iter().zip(direction) {
                assert!((found - expected).abs() < 1e-15, "{of_x:?} for {direction:?}");
            }
        }
    }
}
