//! The messages of a run: every sample of its motion, and its updates between them.

use foxglove::messages::{FrameTransform, FrameTransforms, Pose, PoseInFrame, PosesInFrame, Timestamp, log::Level};
use hpf_sim::task::{Task, Unit};
use hpf_sim::{Metric, Trace};
use mcap::McapError;

use super::ros2::{self, Header, JointState};
use super::scene::{Scene, environment_force};
use super::space::Space;
use super::topic::Topic;
use super::{Log, WORLD, nanoseconds, proto, timestamp};
use crate::results::Run;

/// Most points of a path drawn whole.
const MOST_POINTS: usize = 1000;

impl Log {
    /// Logs a run: what stays, then motion and updates in the order of time, then how it ended.
    pub(super) fn run(&mut self, run: &Run, metrics: &[Metric]) -> Result<(), McapError> {
        if let Some(last) = run.learning.last() {
            self.updates = last.update.max(1);
        }
        let motion = Motion::new(run);
        if let [first, _, ..] = run.learning.as_slice() {
            self.say(0, Level::Info, format!("start: cost {}", short(first.total)))?;
        }
        let paths = motion.paths();
        for (topic, poses) in [(Topic::LearnedPath, &paths[0]), (Topic::ReferencePath, &paths[1])] {
            let path =
                PosesInFrame { timestamp: Some(Timestamp::default()), frame_id: WORLD.into(), poses: poses.clone() };
            self.send(topic, 0, &path)?;
        }
        let scene = Scene::new(motion.task, motion.trace, &motion.space, corners(paths.iter().flatten()));
        self.send(Topic::Scene, 0, &scene.still(&paths[0], &paths[1]))?;

        let mut updates = run.learning.iter().peekable();
        for (i, &time) in motion.trace.time.iter().enumerate() {
            let time = nanoseconds(time);
            while let Some(row) = updates.next_if(|row| self.update_time(row) <= time) {
                self.put_update(row)?;
            }
            self.sample(&motion, i, time)?;
            if i.is_multiple_of(scene.stride()) {
                self.send(Topic::Scene, time, &scene.moving(i, motion.tool_position(i), timestamp(time)))?;
            }
        }
        for row in updates {
            self.put_update(row)?;
        }
        self.results(run, metrics)
    }

    fn sample(&mut self, motion: &Motion<'_>, i: usize, time: u64) -> Result<(), McapError> {
        let stamp = timestamp(time);
        let [tool, reference] = motion.poses(i);
        for (topic, pose) in [(Topic::ToolPose, tool), (Topic::ReferencePose, reference)] {
            let pose = PoseInFrame { timestamp: Some(stamp), frame_id: WORLD.into(), pose: Some(pose) };
            self.send(topic, time, &pose)?;
        }
        let transform = |name: &str, pose: Pose| FrameTransform {
            timestamp: Some(stamp),
            parent_frame_id: WORLD.into(),
            child_frame_id: name.into(),
            translation: pose.position,
            rotation: pose.orientation,
        };
        let transforms = vec![transform("tool", tool), transform("reference", reference)];
        self.send(Topic::Transforms, time, &FrameTransforms { transforms })?;
        self.send(Topic::State, time, &motion.state(i))?;
        self.send_bytes(Topic::Axes, time, &motion.joints(i, Header::new(time, WORLD)))
    }

    fn results(&mut self, run: &Run, metrics: &[Metric]) -> Result<(), McapError> {
        let end = nanoseconds(self.duration).max(run.trajectory.time.last().map_or(0, |&time| nanoseconds(time)));
        if let Some(last) = run.learning.last() {
            // The policy is the best of all evaluations, not the last.
            let cost = short(run.learning.iter().map(|row| row.total).fold(last.total, f64::min));
            let way = match last.update {
                0 => String::new(),
                updates => format!(" after {updates} updates, {} motions", last.rollouts),
            };
            self.say(end, Level::Info, format!("end: cost {cost}{way}"))?;
        }
        for metric in metrics {
            let Some((target, pass)) = metric.target.zip(metric.pass()) else { continue };
            let (level, verdict) = if pass { (Level::Info, "pass") } else { (Level::Warning, "miss") };
            let unit = if metric.unit.is_empty() { String::new() } else { format!(" {}", metric.unit) };
            let (name, value, target) = (metric.name, short(metric.value), short(target));
            self.say(end, level, format!("{verdict}: {name} {value}{unit}, target {target}{unit}"))?;
        }
        Ok(())
    }
}

/// A motion and where it takes place.
pub(super) struct Motion<'a> {
    pub(super) task: &'a Task,
    pub(super) trace: &'a Trace,
    space: Space,
}

impl<'a> Motion<'a> {
    pub(super) fn new(run: &'a Run) -> Self {
        Self { task: &run.task, trace: &run.trajectory, space: Space::new(&run.task) }
    }

    fn travel(&self, i: usize) -> f64 {
        self.trace.contact.as_ref().and_then(|contact| contact.travel.get(i)).copied().unwrap_or_default()
    }

    fn tool_position(&self, i: usize) -> [f64; 3] {
        self.space.position(|a| self.trace.axes[a].position[i], self.travel(i))
    }

    /// Of the tool, and of its reference.
    pub(super) fn poses(&self, i: usize) -> [Pose; 2] {
        let (axes, travel) = (&self.trace.axes, self.travel(i));
        [self.space.pose(|a| axes[a].position[i], travel), self.space.pose(|a| axes[a].reference_position[i], travel)]
    }

    /// The whole path of the tool, and of its reference.
    fn paths(&self) -> [Vec<Pose>; 2] {
        let steps = self.trace.time.len().saturating_sub(1);
        let stride = steps.div_ceil(MOST_POINTS).max(1);
        let poses = (0..steps).step_by(stride).chain([steps]).map(|i| self.poses(i));
        let (tool, reference) = poses.map(|[tool, reference]| (tool, reference)).unzip();
        [tool, reference]
    }

    fn state(&self, i: usize) -> proto::State {
        let (mut linear_axes, mut rotary_axes) = (Vec::new(), Vec::new());
        for (axis, signals) in self.task.axis.iter().zip(&self.trace.axes) {
            match axis.unit {
                Unit::M => linear_axes.push(proto::LinearAxis {
                    name: axis.name.clone(),
                    reference_position_m: signals.reference_position[i],
                    reference_velocity_m_per_s: signals.reference_velocity[i],
                    position_m: signals.position[i],
                    velocity_m_per_s: signals.velocity[i],
                    force_n: signals.force[i],
                    stiffness_n_per_m: signals.stiffness[i],
                    damping_n_s_per_m: signals.damping[i],
                }),
                Unit::Rad => rotary_axes.push(proto::RotaryAxis {
                    name: axis.name.clone(),
                    reference_position_rad: signals.reference_position[i],
                    reference_velocity_rad_per_s: signals.reference_velocity[i],
                    position_rad: signals.position[i],
                    velocity_rad_per_s: signals.velocity[i],
                    torque_n_m: signals.force[i],
                    stiffness_n_m_per_rad: signals.stiffness[i],
                    damping_n_m_s_per_rad: signals.damping[i],
                }),
            }
        }
        let contact = self.trace.contact.as_ref().map(|contact| proto::Contact {
            axis: self.task.axis[contact.axis].name.clone(),
            travel_m: self.travel(i),
            deflection_m: contact.deflection[i],
            deviation_m: contact.deviation[i],
            contact_force_n: contact.force[i],
            set_point_force_n: contact.set_point,
        });
        proto::State { time_s: self.trace.time[i], phase: self.trace.phase[i], linear_axes, rotary_axes, contact }
    }

    /// Force [N] and torque [N m] of the environment on the tool, in space.
    pub(super) fn wrench(&self, i: usize) -> ([f64; 3], [f64; 3]) {
        let load = |a: usize| environment_force(self.task, self.trace, a, i);
        (self.space.vector(load), self.space.torque(load))
    }

    pub(super) fn joints(&self, i: usize, header: Header) -> Vec<u8> {
        let names: Vec<&str> = self.task.axis.iter().map(|axis| axis.name.as_str()).collect();
        let [position, velocity, effort] = [
            self.trace.axes.iter().map(|axis| axis.position[i]).collect::<Vec<_>>(),
            self.trace.axes.iter().map(|axis| axis.velocity[i]).collect(),
            self.trace.axes.iter().map(|axis| axis.force[i]).collect(),
        ];
        let joints = JointState { header, name: &names, position: &position, velocity: &velocity, effort: &effort };
        ros2::to_cdr(&joints)
    }
}

/// The smallest and the largest of each coordinate [m].
fn corners<'p>(poses: impl Iterator<Item = &'p Pose>) -> [[f64; 3]; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for position in poses.filter_map(|pose| pose.position) {
        for (c, value) in [position.x, position.y, position.z].into_iter().enumerate() {
            low[c] = low[c].min(value);
            high[c] = high[c].max(value);
        }
    }
    [low, high]
}

/// A number in four digits.
fn short(value: f64) -> String {
    let rounded = format!("{value:.3e}").parse().unwrap_or(value);
    format!("{rounded:?}")
}
