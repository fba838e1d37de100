//! The loop through a measured force: what tool and contact it can stand.
//!
//! A reading is taken every h. The law turns it into the next command, which the robot reaches in a straight line one
//! step later, or follows by a first-order lag. Tool and contact move with the robot and push back. With the shift `z`,
//! the command u and the force f as the law sees it:
//! ```text
//! law       u = H f           d e' + k e = f or m e'' + d e' + k e = f, exact for f held over the step
//! robot     v = (1 - q) (z - 1)/(h (z - q)) u,   y = u - T v,   a = v (z - 1)/(h z)      q = exp(-h/T), 0 for T = 0
//! reading   r = -(K y + C v + M a)                a: the mean over the last step; [`block`] where a mass is behind K
//! delay     z^-n ((1 - p) + p z^-1) of n + p steps
//! filter    s z/(z - 1 + s),   s = 1 - exp(-2 pi c h)
//! ```
//! The loop is stable iff `1 + L(z)` has no root on or outside the unit circle; L is the product of all. L has no pole
//! outside, so the roots are counted by how often `1 + L` goes around the origin on the circle (Nyquist). What it
//! depends on is affine in K and in M, so the values where a root meets the circle are those where `-(1 + L_0)/L_1` is
//! real: the smallest beyond which a root stays outside is the limit.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | K, C, M | [`Load`]: stiffness, damping and mass that move with the tool | N/m, N s/m, kg |
//! | h, T, c | [`Sampling`]: `dt`, `lag`, `cutoff` | s, s, Hz |
//! | H | the law | m/N |

mod block;
mod circle;

use core::f64::consts::PI;

use block::Block;
use circle::{Angle, Complex};

use crate::admittance::{Inertial, OffsetMotion, step_offset};
use crate::conditioning::settled;
use crate::{ConfigError, Real, error};

/// Most steps that a reading may be old.
pub const MOST_DELAY: f64 = 1000.0;

/// Frequencies looked at below the evenly spaced ones, and how many decades they reach down.
const SLOW: u32 = 256;
const DECADES: f64 = 8.0;

/// Evenly spaced frequencies for each turn that delay and law make on the circle.
const PER_TURN: u32 = 32;

/// Halvings of the distance to a peak.
const PEAK: i32 = 28;

/// More changes between stable and unstable than any loop of so few poles has below its delay's own.
const MOST_CHANGES: u32 = 64;

/// How a force is sampled and a command followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Step of the controller [s].
    pub dt: f64,
    /// Age of a reading [s]: of the contact, at the start of the step.
    pub delay: f64,
    /// Cut-off of the force filter [Hz], if there is one.
    pub cutoff: Option<f64>,
    /// Time constant with which the robot follows its command [s]; 0: it is there one step later.
    pub lag: f64,
}

/// What moves with the tool behind the sensor, and what it touches.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Mass of the tool and of what moves with it [kg].
    pub mass: f64,
    /// Damping of the contact [N s/m].
    pub damping: f64,
    /// Stiffness of the contact [N/m].
    pub stiffness: f64,
    /// Mass behind the spring [kg], free but for it; without one the spring stands on the ground.
    pub behind: Option<f64>,
}

/// What a contact is made of, its stiffness apart.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Contact {
    /// Mass of the tool behind the sensor [kg].
    pub tool: f64,
    /// Mass of what is touched [kg].
    pub mass: f64,
    /// Damping of what is touched [N s/m].
    pub damping: f64,
}

/// What limits a contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Case {
    /// The tool alone oscillates in free air.
    FreeAir,
    /// The mass of the contact moves with the tool, its spring stands on the ground.
    Carried,
    /// The mass of the contact is behind its spring.
    Behind,
}

/// The loop through the measured force of one axis, its gains held.
///
/// ```
/// use hpf_core::passivity::{Contact, ForceLoop, Load, Sampling};
/// let sampling = Sampling { dt: 1e-3, delay: 1e-3, cutoff: None, lag: 0.0 };
/// let bare = ForceLoop::new(None, 0.0, 50.0, &sampling)?; // d = 50 N s/m, first order
/// let (limit, _) = bare.stiffness_limit(&Contact::default());
/// assert!((limit - 50_000.0).abs() < 1e-3); // one step late: d/h
/// assert!(!bare.is_stable(&Load { mass: 0.5, ..Load::default() })); // a tool of 0.5 kg oscillates in free air
/// let filtered = ForceLoop::new(None, 0.0, 50.0, &Sampling { cutoff: Some(10.0), ..sampling })?;
/// assert!(filtered.is_stable(&Load { mass: 0.5, ..Load::default() }));
/// # Ok::<(), hpf_core::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLoop {
    stiffness: f64,
    damping: f64,
    /// Of the law of second order: its mass [kg].
    mass: Option<f64>,
    /// Offset and velocity of the law after a step under 1 N from rest.
    push: [f64; 2],
    sampling: Sampling,
    /// Whole steps of delay, and the rest.
    delay: [f64; 2],
    /// Shares of a change that filter and robot take over in a step.
    settled: [f64; 2],
}

impl ForceLoop {
    /// The loop of a law with `stiffness` k [N/m] and `damping` d [N s/m], of second order where it has a `mass` m [kg].
    ///
    /// # Errors
    /// [`ConfigError`] for a step, damping, mass or cut-off that is not positive, a stiffness, delay or lag that is
    /// negative, and a reading more than 1000 steps old.
    pub fn new(mass: Option<f64>, stiffness: f64, damping: f64, sampling: &Sampling) -> Result<Self, ConfigError> {
        let Sampling { dt, delay, cutoff, lag } = *sampling;
        error::positive("dt", dt)?;
        error::not_negative("stiffness", stiffness)?;
        error::positive("damping", damping)?;
        error::not_negative("lag", lag)?;
        cutoff.map_or(Ok(1.0), |cutoff| error::positive("cutoff", cutoff))?;
        error::not_negative("delay", delay)?;
        // A quotient a few bits off a whole number is meant as that.
        let steps = delay / dt;
        let steps = if (steps - libm::round(steps)).abs() < 1e-9 * steps { libm::round(steps) } else { steps };
        error::within("delay in steps", steps, 0.0, MOST_DELAY)?;
        let push = match mass {
            None => [step_offset(0.0, stiffness, damping, 1.0, dt), 0.0],
            Some(mass) => {
                let mut motion = OffsetMotion { offset: 0.0, velocity: 0.0 };
                Inertial::new(mass, stiffness, damping, dt)?.step(&mut motion, stiffness, damping, 1.0, dt);
                [motion.offset, motion.velocity]
            }
        };
        let whole = libm::floor(steps);
        let robot = if lag > 0.0 { -libm::expm1(-dt / lag) } else { 1.0 };
        let settled = [settled(cutoff, dt), robot];
        Ok(Self { stiffness, damping, mass, push, sampling: *sampling, delay: [whole, steps - whole], settled })
    }

    /// Whether the loop is stable with `load`.
    pub fn is_stable(&self, load: &Load) -> bool {
        let block = load.behind.map(|mass| self.block(mass, load)).transpose();
        let Ok(block) = block else { return false };
        self.turns(self.peaks(load), |at| [self.returned(at, load, block.as_ref()), Complex::real(0.0)], 0.0) == 0
    }

    /// The stiffness [N/m] below which `contact` is stable, and what limits it: 0 where none is, infinite where all are.
    ///
    /// Beyond the limit some stiffness may be stable again; the limit is the smallest that is not. Whether a mass moves
    /// with the tool or gives way behind the spring is not known before: the case that stands less counts.
    pub fn stiffness_limit(&self, contact: &Contact) -> (f64, Case) {
        let Contact { tool, mass, damping } = *contact;
        if !self.is_stable(&Load { mass: tool, ..Load::default() }) {
            return (0.0, Case::FreeAir);
        }
        let carried = self.carried_limit(&Load { mass: tool + mass, damping, ..Load::default() });
        if mass <= 0.0 {
            return (carried, Case::Carried);
        }
        let behind = self.behind_limit(&Load { mass: tool, damping, stiffness: 0.0, behind: Some(mass) }, carried);
        if behind < carried { (behind, Case::Behind) } else { (carried, Case::Carried) }
    }

    /// The limit of a spring on the ground.
    fn carried_limit(&self, load: &Load) -> f64 {
        self.limit(|at| {
            let fixed = self.returned(at, &Load { stiffness: 0.0, ..*load }, None);
            [fixed, self.open(at) * self.moved(at)[0]]
        })
    }

    /// The limit of a spring with a mass behind it, where it is below `most`: the first found among stiffnesses that rise
    /// by a tenth of a decade, then halved in between.
    fn behind_limit(&self, load: &Load, most: f64) -> f64 {
        let is_stable = |stiffness: f64| self.is_stable(&Load { stiffness, ..*load });
        let scale = self.damping / self.sampling.dt;
        let mut low = 0.0;
        for tenth in -60..=30 {
            let mut high = scale * libm::exp10(0.1 * f64::from(tenth));
            if low >= most {
                break;
            }
            if !is_stable(high) {
                // To a billionth of what is left.
                for _ in 0..30 {
                    let middle = 0.5 * (low + high);
                    if is_stable(middle) {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                return low;
            }
            low = high;
        }
        f64::INFINITY
    }

    /// The mass [kg] below which a tool behind the sensor is stable in free air; infinite where all are.
    pub fn tool_mass_limit(&self) -> f64 {
        self.limit(|at| [Complex::ONE, self.open(at) * self.moved(at)[2]])
    }

    /// A mass [kg] of the tool behind the sensor up to which the loop is stable in free air, whatever delay and lag: see
    /// [`safe_tool_mass`].
    pub fn safe_tool_mass(&self) -> f64 {
        safe_tool_mass(self.mass, self.stiffness, self.damping, self.settled[0], self.sampling.dt)
    }

    /// From the reading to the next command.
    fn open(&self, at: &Angle) -> Complex {
        let w = at.less_one;
        let (b, k) = (self.push[0], self.stiffness);
        let law = match self.mass {
            None => Complex::real(b) / (w + Complex::real(b * k)),
            Some(mass) => {
                // G1 and G2 of the step; w2 and 2a are k/m and d/m.
                let [g1, g2] = self.push.map(|push| mass * push);
                let (w2, double_a) = (k / mass, self.damping / mass);
                let velocity = w + Complex::real(double_a * g2 + w2 * g1);
                let pull = velocity * Complex::real(g1) + Complex::real(g2 * g2);
                let poles = (w + Complex::real(w2 * g1)) * velocity + Complex::real(w2 * g2 * g2);
                pull / (Complex::real(mass) * poles)
            }
        };
        let [whole, part] = self.delay;
        let delay = Angle::new(whole * at.angle).z.conjugate()
            * (Complex::real(1.0 - part) + Complex::real(part) * at.z.conjugate());
        let filter = Complex::real(self.settled[0]) * at.z / (w + Complex::real(self.settled[0]));
        law * delay * filter
    }

    /// Position, velocity and mean acceleration of the robot for a command.
    fn moved(&self, at: &Angle) -> [Complex; 3] {
        let (w, settled) = (at.less_one, self.settled[1]);
        let per_step = Complex::real(self.sampling.dt.recip());
        let velocity = Complex::real(settled) * w * per_step / (w + Complex::real(settled));
        let position = Complex::ONE + Complex::real(-self.sampling.lag) * velocity;
        [position, velocity, velocity * w * at.z.conjugate() * per_step]
    }

    /// The mass behind the spring of `load`.
    fn block(&self, mass: f64, load: &Load) -> Result<Block, ConfigError> {
        Block::new(mass, load.stiffness, load.damping, self.sampling.dt, self.sampling.lag)
    }

    /// `1 + L`.
    fn returned(&self, at: &Angle, load: &Load, block: Option<&Block>) -> Complex {
        let [position, velocity, acceleration] = self.moved(at);
        let ([compression, rate], damping) = match block {
            None => ([position, velocity], load.damping),
            Some(block) => {
                let commanded = at.less_one * Complex::real(self.sampling.dt.recip());
                let difference = commanded * at.less_one / (at.less_one + Complex::real(self.settled[1]));
                (block.compressed(at, difference), block.damping())
            }
        };
        let force = Complex::real(load.stiffness) * compression
            + Complex::real(damping) * rate
            + Complex::real(load.mass) * acceleration;
        Complex::ONE + self.open(at) * force
    }

    /// The smallest positive value x from which on `of[0] + x of[1]` has a root outside the circle.
    fn limit(&self, of: impl Fn(&Angle) -> [Complex; 2]) -> f64 {
        let peaks = self.peaks(&Load::default());
        let mut reached = 0.0;
        for _ in 0..MOST_CHANGES {
            let mut next = f64::INFINITY;
            let beyond = reached * (1.0 + 1e-9);
            // Where the value is real: x = -f/g, and Im(f g*) = 0.
            self.around(
                peaks,
                |at| {
                    let [f, g] = of(at);
                    (f * g.conjugate()).im
                },
                |at, _| {
                    let [f, g] = of(at);
                    let value = -(f * g.conjugate()).re / g.square();
                    if value > beyond && value < next {
                        next = value;
                    }
                },
            );
            let between = match (reached > 0.0, next < f64::INFINITY) {
                (_, true) => 0.5 * (reached + next),
                (true, false) => 2.0 * reached,
                (false, false) => 1.0,
            };
            if self.turns(peaks, &of, between) != 0 {
                return reached;
            }
            if next == f64::INFINITY {
                return next;
            }
            reached = next;
        }
        reached
    }

    /// How often `of[0] + x of[1]` goes around the origin on the circle: less by one for each root outside.
    fn turns(&self, peaks: [f64; 2], of: impl Fn(&Angle) -> [Complex; 2], x: f64) -> i32 {
        let sum = |at: &Angle| {
            let [f, g] = of(at);
            f + Complex::real(x) * g
        };
        let mut turns = 0;
        self.around(
            peaks,
            |at| sum(at).im,
            |at, falls| {
                if sum(at).re <= 0.0 {
                    // What crosses the negative axis on one half of the circle does so on the other; -1 is on both.
                    let times = if at.angle < PI { 2 } else { 1 };
                    turns += if falls { times } else { -times };
                }
            },
        );
        turns
    }

    /// Calls `meet` at every angle on the upper half of the circle where `level` changes its sign, with whether it falls;
    /// at last at -1, where every level is zero. `peaks` are angles around which the level may change in less than the
    /// angles' distance.
    fn around(&self, peaks: [f64; 2], level: impl Fn(&Angle) -> f64, mut meet: impl FnMut(&Angle, bool)) {
        let even = PER_TURN * (self.delay[0] as u32 + 8);
        let width = PI / f64::from(even);
        let angle = |i: u32| match i.checked_sub(SLOW) {
            None => width * libm::exp10(-DECADES * f64::from(SLOW - i) / f64::from(SLOW)),
            Some(i) => width * f64::from(i + 1),
        };
        let (mut last, mut value) = (angle(0), level(&Angle::new(angle(0))));
        let mut visit = |next: f64, meet: &mut dyn FnMut(&Angle, bool)| {
            let rises = value > 0.0;
            value = level(&Angle::new(next));
            if (value > 0.0) != rises {
                let (mut low, mut high) = (last, next);
                // Halving leaves nothing between the ends.
                for _ in 0..f64::MANTISSA_DIGITS {
                    let middle = 0.5 * (low + high);
                    if (level(&Angle::new(middle)) > 0.0) == rises {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                meet(&Angle::new(low), rises);
            }
            last = next;
            value > 0.0
        };
        let mut falls = false;
        let mut from = angle(0);
        for i in 1..SLOW + even - 1 {
            let to = angle(i);
            for peak in peaks {
                if peak <= from || peak >= to {
                    continue;
                }
                (1..PEAK).for_each(|j| {
                    visit(peak - (peak - from) * libm::scalbn(1.0, -j), &mut meet);
                });
                (1..PEAK).rev().for_each(|j| {
                    visit(peak + (to - peak) * libm::scalbn(1.0, -j), &mut meet);
                });
                from = peak + 0.5 * (to - peak);
            }
            falls = visit(to, &mut meet);
            from = to;
        }
        meet(&Angle { angle: PI, z: Complex::real(-1.0), less_one: Complex::real(-2.0) }, falls);
    }

    /// Where the law and the mass behind the spring of `load` resound.
    fn peaks(&self, load: &Load) -> [f64; 2] {
        let peak = |stiffness: f64, mass: Option<f64>| {
            let turn = mass.map_or(0.0, |mass| libm::fmod(libm::sqrt(stiffness / mass) * self.sampling.dt, 2.0 * PI));
            turn.min(2.0 * PI - turn)
        };
        [peak(load.stiffness, load.behind), peak(self.stiffness, self.mass)]
    }
}

/// A mass [kg] of the tool behind the sensor up to which the loop is stable in free air, whatever the delay of the reading
/// and the lag of the robot: `damping` d [N s/m], and of the law of second order its `mass` m [kg] and `stiffness` k [N/m];
/// `settled` s is the share of a change that the force filter lets through in a step of `dt` h [s], 1 without one.
///
/// `(d h/2) (2 - s)/s`; of second order, m too where `d^2 >= 2 m k`, and `d sqrt(m/k) sqrt(1 - d^2/(4 m k))` below. Up to it
/// the loop's gain is below 1 at every frequency. A heavier tool is safe at some delays and not at others;
/// [`ForceLoop::tool_mass_limit`] says which.
///
/// ```
/// use hpf_core::passivity::safe_tool_mass;
/// assert_eq!(safe_tool_mass(None, 100.0, 50.0, 1.0, 1e-3), 0.025); // d h/2 at 1 kHz, no filter
/// assert_eq!(safe_tool_mass(Some(2.0), 100.0, 50.0, 1.0, 1e-3), 2.0); // a virtual mass as heavy as the tool
/// ```
#[inline]
pub fn safe_tool_mass<T: Real + PartialOrd>(mass: Option<T>, stiffness: T, damping: T, settled: T, dt: T) -> T {
    let two = T::of(2.0);
    let sampled = damping * dt * (two - settled) / (two * settled);
    let Some(mass) = mass else { return sampled };
    // 4 zeta^2: below 2 the law swings, and answers a force of its own frequency more than its mass would.
    let share = damping * damping / (mass * stiffness);
    let own = if share < two { mass * (share * (T::ONE - share * T::of(0.25))).sqrt() } else { mass };
    if own > sampled { own } else { sampled }
}
