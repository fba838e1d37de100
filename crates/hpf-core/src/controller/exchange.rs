//! What goes into a controller at every step, and what comes out.

use super::Mode;
use crate::limits::Hits;

/// One step's input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Input<T, const D: usize> {
    /// Force of the environment ON the tool as the sensor reads it [N].
    pub measured_force: [T; D],
    /// Steps since that reading was taken: 0 is fresh.
    pub force_age: u32,
    /// Position of the robot [axis unit], where it is to be watched.
    pub measured_position: Option<[T; D]>,
    /// Rate of time along the path, in [0, 1].
    pub rate: T,
    /// What is asked for, once.
    pub request: Option<Request<T, D>>,
}

/// A request to a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request<T, const D: usize> {
    /// Start the movement from where the command is.
    Start,
    /// Pause on the path.
    Hold,
    /// Go on along the path.
    Resume,
    /// Stop on the path for good.
    Stop,
    /// Go to another goal [axis unit].
    Goal([T; D]),
    /// Call the present force zero; without contact, in Idle, where it has stood still ([`Status::tare_ready`]): the mean
    /// of the last readings becomes [`Controller::bias`](super::Controller::bias). Refused elsewhere.
    Tare,
    /// Back to Idle at the measured position [axis unit] of a robot at rest.
    Reset([T; D]),
}

/// One step's output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Output<T, const D: usize> {
    /// One command per axis.
    pub axes: [AxisOutput<T>; D],
    /// Phase s: 1 at the start, falling.
    pub phase: T,
    /// Rate at which time has run along the path.
    pub rate: T,
    /// Energy in the tank [J]; zero without one.
    pub energy: T,
    /// Energy at the physical port [J]; zero without one.
    pub port_energy: T,
    /// What the controller does.
    pub mode: Mode,
    /// What has happened in this step.
    pub status: Status,
}

/// The command of one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisOutput<T> {
    /// Commanded position [axis unit].
    pub position: T,
    /// Commanded velocity: how fast it got there from the last command [axis unit/s].
    pub velocity: T,
    /// Stiffness [N/m].
    pub stiffness: T,
    /// Damping [N s/m].
    pub damping: T,
    /// Offset: commanded minus reference position [axis unit].
    pub offset: T,
    /// Force as the model saw it, conditioned and limited [N].
    pub force: T,
    /// Limits that have cut this command.
    pub hits: Hits,
}

/// What has happened in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Status {
    /// The movement has ended: set once.
    pub ended: bool,
    /// dt was not finite or below 1 us: the command stands still, at velocity 0, and shows the last force.
    pub bad_time: bool,
    /// dt was longer than allowed and was cut.
    pub long_time: bool,
    /// The force of an axis was not finite, or all of it too old: the last good one stands in.
    pub bad_force: bool,
    /// The force has been bad for longer than may be bridged: offsets are frozen, and the path stops.
    pub force_lost: bool,
    /// A measured position has been bad for longer than may be bridged: the path stops.
    pub position_lost: bool,
    /// The rate has been bad for longer than may be bridged: the path stops.
    pub rate_lost: bool,
    /// dt has been bad or long for more steps than may be bridged: the path stops.
    pub time_lost: bool,
    /// Rate or measured position was not finite and was not used.
    pub bad_input: bool,
    /// The request was refused.
    pub refused: bool,
    /// A force was above its trip level.
    pub force_tripped: bool,
    /// The robot was further from the command than allowed.
    pub tracking_tripped: bool,
    /// The energy tank has held back stiffness, motion along the path or a force set-point, or the port a motion.
    pub energy_short: bool,
    /// In Idle: the force has stood still long enough for a tare.
    pub tare_ready: bool,
}

impl Status {
    /// Whether an input is lost: the path stops, and then the mode is Fault.
    #[inline]
    pub fn lost(self) -> bool {
        self.force_lost || self.position_lost || self.rate_lost || self.time_lost
    }
}

/// How often each has happened since the controller was made; they stop at their largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Steps with a dt that was not finite or below 1 us.
    pub bad_time: u32,
    /// Steps with a dt that was too long.
    pub long_time: u32,
    /// Steps with a force that was not finite or too old.
    pub bad_force: u32,
    /// Steps with a rate or a measured position that was not finite.
    pub bad_input: u32,
    /// Requests and settings refused.
    pub refused: u32,
    /// Forces above their trip level and robots that did not follow.
    pub trips: u32,
    /// Entries into Fault.
    pub faults: u32,
}

/// Counts one more.
pub(super) fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}
