//! The settings file of `hpf run --controller`: everything beside the skill, and what is asked of the controller when.

use core::array;

use hpf_core::ConfigError;
use hpf_core::conditioning::ForceConditioning;
use hpf_core::controller::{self as control, AxisSettings, Compliance};
use hpf_core::domain::{LARGEST, SMALLEST};
use hpf_core::limits;
use hpf_core::passivity;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::task::{self, Axis, Mistakes, PerAxis, plain};

/// A number of the controller that nothing reaches: what is not limited.
const WIDE: f64 = 1e6;

/// The settings of a controller in a task; what is left out is not limited, not guarded and not asked for.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Settings {
    /// What each axis does with force, one for all or one per axis; left out, it gives way, and presses where the task has
    /// a contact with a force.
    pub compliance: Option<PerAxisKind>,
    /// Force on the environment of axes that press [N], along the axis: one below zero presses the other way. Left out, that
    /// of the task's contact.
    pub press: Option<PerAxis>,
    /// Whether the robot's position goes into the controller, which then stops where the robot does not follow.
    pub watch_position: bool,
    /// What a command never exceeds.
    pub limits: Limits,
    /// Where the controller stops.
    pub trips: Trips,
    /// From the sensor's reading to the force that the model sees.
    pub readings: Readings,
    /// Guard of passivity, if there is one.
    pub tank: Option<Tank>,
    /// Guard of passivity at the robot itself, if there is one; it needs the tank.
    pub port: Option<Port>,
    /// Time and its faults.
    pub timing: Timing,
    /// What is asked for, and when; a movement that nobody starts starts at once.
    #[schemars(length(max = 1000))]
    pub request: Vec<TimedRequest>,
}

/// One kind for all axes, or one per axis.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(untagged)]
pub enum PerAxisKind {
    /// The same for all.
    All(Kind),
    /// One per axis.
    Each(#[schemars(length(min = 1, max = 7))] Vec<Kind>),
}

/// What an axis does with force.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Gives way by the law of the skill.
    Compliant,
    /// Gives way and presses.
    Press,
    /// Follows the reference.
    Rigid,
}

/// What a command never exceeds; a number for all axes or one per axis.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Limits {
    /// Largest force that enters the model [N].
    pub force: Option<PerAxis>,
    /// Largest offset from the reference [m].
    pub offset: Option<PerAxis>,
    /// Largest commanded velocity [m/s].
    pub velocity: Option<PerAxis>,
    /// Largest change of the commanded velocity [m/s^2].
    pub acceleration: Option<PerAxis>,
    /// Smallest commanded position [m].
    pub position_min: Option<PerAxis>,
    /// Largest commanded position [m].
    pub position_max: Option<PerAxis>,
}

/// Where the controller stops; a number for all axes or one per axis.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Trips {
    /// At a larger force [N].
    pub force: Option<PerAxis>,
    /// At a larger distance between command and robot [m].
    pub tracking: Option<PerAxis>,
}

/// From the sensor's reading to the force that the model sees.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Readings {
    /// Mass that hangs on the sensor [kg].
    #[schemars(range(min = 0, max = LARGEST))]
    pub tool_mass: f64,
    /// Gravity along each axis [m/s^2].
    pub gravity: PerAxis,
    /// Cut-off of the force filter [Hz]; left out, no filter.
    #[schemars(range(min = SMALLEST, max = LARGEST))]
    pub cutoff: Option<f64>,
    /// Half width of the dead zone [N].
    pub dead_zone: PerAxis,
}

impl Default for Readings {
    fn default() -> Self {
        Self { tool_mass: 0.0, gravity: PerAxis::All(0.0), cutoff: None, dead_zone: PerAxis::All(0.0) }
    }
}

/// Guard of passivity.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Tank {
    /// The most it holds, and what it starts with [J].
    #[schemars(range(min = SMALLEST, max = LARGEST))]
    pub capacity: f64,
    /// What switching leaves in it [J].
    #[serde(default)]
    #[schemars(range(min = 0, max = LARGEST))]
    pub reserve: f64,
    /// Share of what is dissipated that comes back.
    #[serde(default)]
    #[schemars(range(min = 0, max = 1))]
    pub refill: f64,
    /// The most that switching may put into one axis [W].
    #[serde(default = "default_power")]
    #[schemars(range(min = SMALLEST, max = LARGEST))]
    pub power: f64,
}

fn default_power() -> f64 {
    100.0
}

/// What is known of the sensor and the robot where the robot meets its environment.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Port {
    /// How many steps a fresh reading may be late.
    #[schemars(range(min = 0, max = 6))]
    pub force_delay: u32,
    /// The most a reading may be off, after tare [N].
    pub force_bias: PerAxis,
}

impl Default for Port {
    fn default() -> Self {
        Self { force_delay: 0, force_bias: PerAxis::All(0.0) }
    }
}

/// Time and its faults.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(default)]
#[schemars(deny_unknown_fields)]
pub struct Timing {
    /// Time for the rate to go from 0 to 1 or back under way [s].
    #[schemars(range(min = 0, max = 10))]
    pub ramp: f64,
    /// How long the last good force may stand in for a bad one [s].
    #[schemars(range(min = 0, max = 1))]
    pub hold: f64,
    /// Oldest reading that is still good [steps].
    pub oldest_force: u32,
}

impl Default for Timing {
    fn default() -> Self {
        Self { ramp: 0.2, hold: 0.02, oldest_force: 4 }
    }
}

/// A request and its time.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum TimedRequest {
    /// Start the movement.
    Start(At),
    /// Pause on the path.
    Hold(At),
    /// Go on along the path.
    Resume(At),
    /// Stop on the path for good.
    Stop(At),
    /// Call the present force zero.
    Tare(At),
    /// Back to Idle where the robot is.
    Reset(At),
    /// Go to another goal.
    Goal(GoalAt),
    /// Another rate of time along the path from then on.
    Rate(RateAt),
}

/// When.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct At {
    /// When it is asked for [s].
    #[schemars(range(min = 0))]
    pub time: f64,
}

/// When, and where to.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct GoalAt {
    /// When it is asked for [s].
    #[schemars(range(min = 0))]
    pub time: f64,
    /// The goal, one number per axis [m].
    pub position: PerAxis,
}

/// When, and how fast.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct RateAt {
    /// When it is asked for [s].
    #[schemars(range(min = 0))]
    pub time: f64,
    /// Rate of time along the path.
    #[schemars(range(min = 0, max = 1))]
    pub rate: f64,
}

impl TimedRequest {
    /// When it is asked for [s].
    pub fn time(&self) -> f64 {
        match self {
            Self::Start(at) | Self::Hold(at) | Self::Resume(at) | Self::Stop(at) | Self::Tare(at) | Self::Reset(at) => {
                at.time
            }
            Self::Goal(at) => at.time,
            Self::Rate(at) => at.time,
        }
    }
}

/// A list of `count` entries has one for each of `axes`.
fn check_length(path: &str, count: Option<usize>, axes: usize, say: &mut dyn FnMut(&str, String, String)) {
    if let Some(count) = count.filter(|count| *count != axes) {
        let kind = if axes == 1 { "axis" } else { "axes" };
        say(path, format!("{count} entries for {axes} {kind}"), "one value for all axes, or one for each".into());
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            compliance: None,
            press: None,
            watch_position: true,
            limits: Limits::default(),
            trips: Trips::default(),
            readings: Readings::default(),
            tank: None,
            port: None,
            timing: Timing::default(),
            request: Vec::new(),
        }
    }
}

impl Settings {
    /// Reads a settings file for a task of the axes `axes`.
    ///
    /// # Errors
    /// Every mistake of keys, types, ranges and lengths with its place, in the order of the text; a workspace without a
    /// width, or one that leaves out where an axis starts or ends; a press above the largest force.
    pub fn parse(text: &str, axes: &[Axis]) -> Result<Self, Mistakes> {
        task::read(text, &Self::schema(), "a settings file", |settings: &Self, say| settings.check(axes, say))
    }

    /// The JSON schema of the settings file.
    pub fn schema() -> serde_json::Value {
        serde_json::Value::from(schemars::schema_for!(Self))
    }

    /// What a schema cannot say.
    fn check(&self, axes: &[Axis], say: &mut dyn FnMut(&str, String, String)) {
        if let Some(Tank { capacity, reserve, .. }) =
            self.tank.as_ref().filter(|tank| tank.reserve > tank.capacity.max(0.0))
        {
            let message = format!("`reserve` is above `capacity`: {reserve} J of {capacity} J");
            say("tank.reserve", message, format!("`reserve` must lie between 0 and {capacity}"));
        }
        if self.port.is_some() && self.tank.is_none() {
            say("port", "a port without a tank".into(), "the port keeps the tank's energy: add [tank]".into());
        }
        self.check_lists(axes.len(), say);
        self.check_axes(axes, say);
    }

    /// Lists as long as they must be, of numbers that a controller takes.
    fn check_lists(&self, axes: usize, say: &mut dyn FnMut(&str, String, String)) {
        let Limits { force, offset, velocity, acceleration, position_min, position_max } = &self.limits;
        let positive = [SMALLEST, LARGEST];
        let size = [0.0, LARGEST];
        let either_way = [-LARGEST, LARGEST];
        let lists = [
            ("limits.force", force.as_ref(), positive),
            ("limits.offset", offset.as_ref(), positive),
            ("limits.velocity", velocity.as_ref(), positive),
            ("limits.acceleration", acceleration.as_ref(), positive),
            ("limits.position_min", position_min.as_ref(), either_way),
            ("limits.position_max", position_max.as_ref(), either_way),
            ("trips.force", self.trips.force.as_ref(), positive),
            ("trips.tracking", self.trips.tracking.as_ref(), positive),
            ("press", self.press.as_ref(), either_way),
            ("readings.gravity", Some(&self.readings.gravity), either_way),
            ("readings.dead_zone", Some(&self.readings.dead_zone), size),
            ("port.force_bias", self.port.as_ref().map(|port| &port.force_bias), size),
        ];
        let goals = self.request.iter().enumerate().filter_map(|(i, request)| match request {
            TimedRequest::Goal(goal) => Some((format!("request.{i}.position"), &goal.position)),
            _ => None,
        });
        let lists = lists.into_iter().filter_map(|(path, list, bounds)| Some((path.to_owned(), list?, bounds)));
        for (path, list, [least, most]) in lists.chain(goals.map(|(path, goal)| (path, goal, either_way))) {
            check_length(&path, list.count(), axes, say);
            let key = path.rsplit('.').next().unwrap_or(&path);
            for (i, number) in list.values().iter().enumerate().filter(|(_, number)| !(least..=most).contains(*number))
            {
                let help = format!("`{key}` must lie between {} and {}", plain(least), plain(most));
                say(&list.place(&path, i), format!("`{key}` is out of range: {}", plain(*number)), help);
            }
        }
        if let Some(PerAxisKind::Each(each)) = &self.compliance {
            check_length("compliance", Some(each.len()), axes, say);
        }
    }

    /// What fits no axis of the task, as far as lists reach.
    fn check_axes(&self, axes: &[Axis], say: &mut dyn FnMut(&str, String, String)) {
        let Limits { force, position_min, position_max, .. } = &self.limits;
        let of = |list: &Option<PerAxis>, axis: usize| list.as_ref().and_then(|list| list.get(axis));
        for (i, axis) in axes.iter().enumerate() {
            let (name, unit) = (&axis.name, axis.unit.symbol());
            let [min, max] =
                [(position_min, -WIDE), (position_max, WIDE)].map(|(bound, wide)| of(bound, i).unwrap_or(wide));
            let path = if position_max.is_some() { "limits.position_max" } else { "limits.position_min" };
            if min >= max {
                let message = format!("the workspace of axis `{name}` has no width: {min} to {max} {unit}");
                say(path, message, "`position_min` must lie below `position_max`".into());
                continue;
            }
            for (what, place) in [("starts", axis.start), ("ends", axis.goal)] {
                if !(min..=max).contains(&place) {
                    let path = if place < min { "limits.position_min" } else { "limits.position_max" };
                    let message = format!("axis `{name}` {what} at {place} {unit}, outside its workspace");
                    let space = match (position_min, position_max) {
                        (Some(_), Some(_)) => format!("{min} to {max} {unit}"),
                        (Some(_), None) => format!("from {min} {unit} on"),
                        _ => format!("up to {max} {unit}"),
                    };
                    say(path, message, format!("the workspace of `{name}` is {space}"));
                }
            }
            let largest = of(force, i).unwrap_or(WIDE);
            if let Some(press) = of(&self.press, i).filter(|press| press.abs() > largest) {
                let message = format!("`press` of axis `{name}` is {press}, above its largest force, {largest}");
                say("press", message, "`press` must not exceed `limits.force`".into());
            }
        }
    }

    /// As a controller takes them, where axis a is to press with `push` on its environment [N] and steps take `dt` [s] at
    /// most. Lists have as many entries as there are axes: [`Settings::parse`] sees to it.
    ///
    /// # Errors
    /// [`ConfigError`] for a tank that cannot be.
    pub fn controller<const D: usize>(
        &self,
        push: [f64; D],
        dt: f64,
    ) -> Result<control::Settings<f64, D>, ConfigError> {
        let of = |numbers: &Option<PerAxis>, axis: usize, wide: f64| {
            numbers.as_ref().map_or(wide, |numbers| numbers.of(axis))
        };
        let l = &self.limits;
        let axes = array::from_fn(|axis| {
            let press = self.press.as_ref().map_or(push[axis], |press| press.of(axis));
            // One number for all is for the axes that have something to press on.
            let presses = if let Some(PerAxis::Each(_)) = self.press { press != 0.0 } else { push[axis] != 0.0 };
            let kind = match &self.compliance {
                Some(PerAxisKind::All(kind)) => *kind,
                Some(PerAxisKind::Each(kinds)) => kinds[axis],
                None if presses => Kind::Press,
                None => Kind::Compliant,
            };
            AxisSettings {
                compliance: match kind {
                    Kind::Rigid => Compliance::Rigid,
                    Kind::Compliant => Compliance::Compliant,
                    Kind::Press => Compliance::Press(press),
                },
                limits: limits::Limits {
                    force: of(&l.force, axis, WIDE),
                    offset: of(&l.offset, axis, WIDE),
                    velocity: of(&l.velocity, axis, WIDE),
                    acceleration: of(&l.acceleration, axis, WIDE),
                    position: [of(&l.position_min, axis, -WIDE), of(&l.position_max, axis, WIDE)],
                },
                trip_force: of(&self.trips.force, axis, WIDE),
                tracking: of(&self.trips.tracking, axis, WIDE),
            }
        });
        let Readings { tool_mass, cutoff, .. } = self.readings;
        let conditioning = ForceConditioning {
            tool_mass,
            gravity: array::from_fn(|axis| self.readings.gravity.of(axis)),
            cutoff,
            dead_zone: array::from_fn(|axis| self.readings.dead_zone.of(axis)),
        };
        let tank = self.tank.as_ref();
        let tank = tank
            .map(|tank| passivity::EnergyTank::new(tank.capacity, tank.reserve, tank.refill, tank.power))
            .transpose()?;
        let port = self.port.as_ref().map(|port| passivity::Port {
            force_delay: port.force_delay,
            force_bias: array::from_fn(|axis| port.force_bias.of(axis)),
        });
        let Timing { ramp, hold, oldest_force } = self.timing;
        Ok(control::Settings {
            axes,
            conditioning,
            tank,
            port,
            timing: control::Timing { longest_step: dt, ramp, hold, oldest_force },
        })
    }
}
