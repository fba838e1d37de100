//! Orientation as three ordinary axes: a chart around the goal, movement on it, and compliance of an orientation.
//!
//! ```text
//! chart       R = Exp(r) R_g,   r = Log(R R_g^T),   w = J_l(r) r'
//! compliance  R_c = Exp(delta) R_ref,   D delta' + K delta = J_l(delta)^T torque
//!             w_c = J_l(delta) delta' + Exp(delta) w_ref
//! power       force x rate of the law = torque . (w_c - Exp(delta) w_ref);   of the reference: torque . Exp(delta) w_ref
//! ```
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | R, `R_g`, `R_ref`, `R_c` | orientation of the tool; the goal, the reference, the commanded one | 1 |
//! | r | coordinates: rotation vector from the goal to the tool, base frame | rad |
//! | delta | offset: rotation vector from the reference to the commanded orientation, base frame | rad |
//! | torque | of the environment ON the tool, base frame | N m |
//! | w | angular velocity, base frame | rad/s |
//! | `J_l` | [left Jacobian](crate::rotation::left_jacobian) | 1 |
//!
//! The coordinates are three axes in rad with goal 0: [`Movement`](crate::Movement), learning and bounds work on them
//! unchanged. They are smooth for `|r| < 2 pi`, so a path may pass a half turn; what is ambiguous there is only where it
//! starts: [`Chart::coordinates`] takes the short way.
//!
//! The work of the law on the chart is stored or dissipated to the last digits, as that of three ordinary axes. The
//! work of the torque held over a step at the tool differs from it by the second order of the step, for the direction in
//! which a torque acts turns within the step. With `J_l` at the mid-step offset ([`generalized_torque`]) the step is
//! second order; with `J_l` at its start, first order.
//!
//! Source: Koutras, Doulgeri, A correct formulation for the orientation dynamic movement primitives for robot control in
//! the Cartesian space, CoRL 2019, whose e is -r.

use crate::admittance::{coupled_velocity, step_offset};
use crate::rotation::{
    Quaternion, add_scaled, dot, left_jacobian, left_jacobian_inverse, length, times, transposed_times,
};
use crate::{Real, Symmetric};

/// Orientations around a goal, as rotation vectors.
///
/// ```
/// use hpf_core::{orientation::Chart, rotation::Quaternion};
/// let chart = Chart::new(Quaternion::exp([0.0, 0.0, 0.5_f64]));
/// let start = Quaternion::exp([0.0, 0.0, 2.0]);
/// let [x, y, z] = chart.coordinates(&start);
/// assert!(x == 0.0 && y == 0.0 && (z - 1.5).abs() < 1e-15); // 1.5 rad about z from the goal to the start
/// assert!(chart.orientation([0.0; 3]).distance(&Quaternion::exp([0.0, 0.0, 0.5])) < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chart<T> {
    goal: Quaternion<T>,
}

impl<T: Real> Chart<T> {
    /// The chart around a goal.
    pub fn new(goal: Quaternion<T>) -> Self {
        Self { goal }
    }

    /// The goal, whose coordinates are zero.
    pub fn goal(&self) -> Quaternion<T> {
        self.goal
    }

    /// The coordinates of an orientation [rad], the short way round: of length pi at most.
    /// [`Quaternion::is_half_turn`] of [`from_goal`](Self::from_goal) says where that was decided by rounding.
    #[inline]
    pub fn coordinates(&self, orientation: &Quaternion<T>) -> [T; 3] {
        self.from_goal(orientation).log()
    }

    /// The coordinates of an orientation [rad], the long way round: of length pi at least.
    #[inline]
    pub fn coordinates_long(&self, orientation: &Quaternion<T>) -> [T; 3] {
        self.from_goal(orientation).log_long()
    }

    /// The rotation from the goal to an orientation.
    #[inline]
    pub fn from_goal(&self, orientation: &Quaternion<T>) -> Quaternion<T> {
        *orientation * self.goal.conjugate()
    }

    /// The orientation at `coordinates` [rad].
    #[inline]
    pub fn orientation(&self, coordinates: [T; 3]) -> Quaternion<T> {
        Quaternion::exp(coordinates) * self.goal
    }

    /// Coordinates and their rates [rad, rad/s] in the chart around another goal, the short way round: the orientation and
    /// its angular velocity stay the same.
    ///
    /// ```
    /// use hpf_core::{orientation::{Chart, angular_velocity}, rotation::Quaternion};
    /// let old = Chart::new(Quaternion::exp([0.4_f64, 0.0, 0.0]));
    /// let new = Chart::new(Quaternion::exp([0.0, -0.6, 0.3]));
    /// let (r, rate) = ([0.2, 0.1, -0.9], [1.0, 0.0, 0.5]);
    /// let (moved, moved_rate) = old.rechart(&new, r, rate);
    /// assert!(old.orientation(r).distance(&new.orientation(moved)) < 1e-15);
    /// let (before, after) = (angular_velocity(r, rate), angular_velocity(moved, moved_rate));
    /// assert!(before.iter().zip(after).all(|(before, after)| (before - after).abs() < 1e-14));
    /// ```
    #[inline]
    pub fn rechart(&self, to: &Self, coordinates: [T; 3], rates: [T; 3]) -> ([T; 3], [T; 3]) {
        let moved = to.coordinates(&self.orientation(coordinates));
        (moved, coordinate_rates(moved, angular_velocity(coordinates, rates)))
    }
}

/// Angular velocity [rad/s] at `coordinates` [rad] that change at `rates` [rad/s]: `J_l(r) r'`.
///
/// ```
/// use hpf_core::orientation::angular_velocity;
/// assert_eq!(angular_velocity([0.0, 0.0, 2.0], [0.0, 0.0, -1.5]), [0.0, 0.0, -1.5]); // along the same axis
/// ```
#[inline]
pub fn angular_velocity<T: Real>(coordinates: [T; 3], rates: [T; 3]) -> [T; 3] {
    times(&left_jacobian(coordinates), rates)
}

/// Rates [rad/s] of coordinates [rad], shorter than 2 pi, at an angular `velocity` [rad/s]: `J_l(r)^-1 w`.
///
/// ```
/// use hpf_core::orientation::coordinate_rates;
/// assert_eq!(coordinate_rates([0.0; 3], [1.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
/// ```
#[inline]
pub fn coordinate_rates<T: Real>(coordinates: [T; 3], velocity: [T; 3]) -> [T; 3] {
    times(&left_jacobian_inverse(coordinates), velocity)
}

/// The scale A of the forcing term for coordinates that start at `start` [rad]: their length, so that it does not depend on
/// the axes; a component of them may be zero.
///
/// ```
/// assert_eq!(hpf_core::orientation::forcing_scale([0.0, 0.6, 0.8]), 1.0);
/// ```
#[inline]
pub fn forcing_scale<T: Real>(start: [T; 3]) -> T {
    length(start)
}

/// The force of the law on an offset, `J_l(delta)^T torque` [N m], at the mid-step offset: `half` leads from the force at
/// the start of the step to the offset half a step later, by whatever law the axes have.
///
/// ```
/// use hpf_core::{admittance::step_offset, orientation::generalized_torque};
/// // A torque along the offset acts as it is.
/// let force = generalized_torque([0.0, 0.3, 0.0], [0.0, 2.0, 0.0], |force| {
///     [0.0, step_offset(0.3, 20.0, 1.0, force[1], 5e-4), 0.0]
/// });
/// assert_eq!(force, [0.0, 2.0, 0.0]);
/// ```
#[inline]
pub fn generalized_torque<T: Real>(offset: [T; 3], torque: [T; 3], half: impl FnOnce([T; 3]) -> [T; 3]) -> [T; 3] {
    let first = transposed_times(&left_jacobian(offset), torque);
    transposed_times(&left_jacobian(half(first)), torque)
}

/// One step of an offset of orientation, and what it was driven by.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetStep<T> {
    /// Offset delta after the step [rad].
    pub offset: [T; 3],
    /// The force of the law that was held over the step, `J_l^T torque` [N m].
    pub force: [T; 3],
}

/// Work of a torque that is held over a step of an offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OffsetWork<T> {
    /// On the chart [J]: what the law stores and dissipates.
    pub chart: T,
    /// At the tool, which turns from offset to offset by the least rotation [J].
    pub tool: T,
}

impl<T: Real> OffsetWork<T> {
    /// The smaller of both [J]: what a tank may count as received. Where the tool has given more than the law knows of, it
    /// is charged for the difference.
    #[inline]
    pub fn safe(&self) -> T {
        self.chart.min(self.tool)
    }
}

impl<T: Real> OffsetStep<T> {
    /// The work of `torque` [N m] over this step from the offset `before` [rad].
    ///
    /// ```
    /// use hpf_core::orientation::step_rotation;
    /// let (before, torque) = ([0.3_f64, 0.2, -0.1], [1.0, -2.0, 0.5]);
    /// let step = step_rotation(before, [20.0; 3], [2.0; 3], torque, 1e-3);
    /// let work = step.work(before, torque);
    /// assert!((work.chart - work.tool).abs() < 1e-7 && work.safe() <= work.tool); // they differ by the cube of the step
    /// ```
    #[inline]
    pub fn work(&self, before: [T; 3], torque: [T; 3]) -> OffsetWork<T> {
        let turned = (Quaternion::exp(self.offset) * Quaternion::exp(before).conjugate()).log();
        OffsetWork { chart: dot(self.force, add_scaled(self.offset, before, -T::ONE)), tool: dot(torque, turned) }
    }
}

/// One step of three axes of first order under a `torque` [N m], with `stiffness` [N m/rad] and `damping` [N m s/rad] taken
/// at mid-step, over `dt` [s].
///
/// ```
/// use hpf_core::orientation::step_rotation;
/// let step = step_rotation([0.0; 3], [20.0, 10.0, 10.0], [2.0, 1.0, 1.0], [4.0, 0.0, 0.0], 1e3); // a long torque
/// assert!((step.offset[0] - 0.2_f64).abs() < 1e-15); // settles at torque over stiffness
/// ```
#[inline]
pub fn step_rotation<T: Real>(
    offset: [T; 3],
    stiffness: [T; 3],
    damping: [T; 3],
    torque: [T; 3],
    dt: T,
) -> OffsetStep<T> {
    let step = |[fx, fy, fz]: [T; 3], dt: T| {
        let ([ox, oy, oz], [kx, ky, kz], [dx, dy, dz]) = (offset, stiffness, damping);
        [step_offset(ox, kx, dx, fx, dt), step_offset(oy, ky, dy, fy, dt), step_offset(oz, kz, dz, fz, dt)]
    };
    let force = generalized_torque(offset, torque, |force| step(force, dt * T::of(0.5)));
    OffsetStep { offset: step(force, dt), force }
}

/// [`step_rotation`] with a stiffness [N m/rad] and a damping [N m s/rad] that have directions.
///
/// ```
/// use hpf_core::{Symmetric, orientation::{step_rotation, step_rotation_coupled}};
/// let (k, d, torque) = ([20.0, 5.0, 10.0], [2.0, 1.0, 1.5], [1.0, -2.0, 0.5]);
/// let coupled =
///     step_rotation_coupled([0.1_f64; 3], &Symmetric::diagonal(k), &Symmetric::diagonal(d), torque, 0.01).offset;
/// let axes = step_rotation([0.1; 3], k, d, torque, 0.01).offset;
/// assert!(coupled.iter().zip(axes).all(|(coupled, axis)| (coupled - axis).abs() < 1e-15));
/// ```
#[inline]
pub fn step_rotation_coupled<T: Real>(
    offset: [T; 3],
    stiffness: &Symmetric<T>,
    damping: &Symmetric<T>,
    torque: [T; 3],
    dt: T,
) -> OffsetStep<T> {
    let modes = stiffness.modes(damping);
    let step = |force, dt| modes.step(offset, force, dt);
    let force = generalized_torque(offset, torque, |force| step(force, dt * T::of(0.5)));
    OffsetStep { offset: step(force, dt), force }
}

/// Rate of an offset [rad/s] under a `torque` [N m]: `D^-1 (J_l(delta)^T torque - K delta)`.
///
/// ```
/// use hpf_core::{Symmetric, orientation::offset_rate};
/// let [stiffness, damping] = [20.0_f64, 2.0].map(Symmetric::isotropic);
/// let [x, y, z] = offset_rate([0.0; 3], &stiffness, &damping, [1.0, 2.0, -4.0]);
/// assert!((x - 0.5).abs() < 1e-15 && (y - 1.0).abs() < 1e-15 && (z + 2.0).abs() < 1e-15);
/// ```
#[inline]
pub fn offset_rate<T: Real>(
    offset: [T; 3],
    stiffness: &Symmetric<T>,
    damping: &Symmetric<T>,
    torque: [T; 3],
) -> [T; 3] {
    coupled_velocity(offset, stiffness, damping, transposed_times(&left_jacobian(offset), torque))
}

/// Orientation and angular velocity that are commanded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Commanded<T> {
    /// Orientation `R_c`.
    pub orientation: Quaternion<T>,
    /// Angular velocity `w_c`, base frame [rad/s].
    pub velocity: [T; 3],
}

/// What an `offset` [rad] that changes at `rate` [rad/s] makes of a reference.
///
/// ```
/// use hpf_core::{orientation::{Commanded, commanded}, rotation::Quaternion};
/// let reference = Commanded { orientation: Quaternion::IDENTITY, velocity: [1.0_f64, 0.0, 0.0] };
/// // An offset of a quarter turn about z stands still: the reference turns about x, the tool about y.
/// let found = commanded([0.0, 0.0, core::f64::consts::FRAC_PI_2], [0.0; 3], &reference);
/// assert!((found.velocity[1] - 1.0).abs() < 1e-15 && found.velocity[0].abs() < 1e-15);
/// ```
#[inline]
pub fn commanded<T: Real>(offset: [T; 3], rate: [T; 3], reference: &Commanded<T>) -> Commanded<T> {
    let turn = Quaternion::exp(offset);
    Commanded {
        orientation: turn * reference.orientation,
        velocity: add_scaled(angular_velocity(offset, rate), turn.turn(reference.velocity), T::ONE),
    }
}

/// What the reference gives to the environment [W], `-torque . Exp(delta) w_ref`, and a tank is charged for; it is not
/// `J_l^T torque` times the rate of the reference's coordinates.
///
/// ```
/// use hpf_core::orientation::reference_power;
/// // Without an offset: 2 N m that brake a reference of 3 rad/s take 6 W.
/// assert_eq!(reference_power([0.0; 3], [-2.0, 0.0, 0.0], [3.0, 0.0, 0.0]), 6.0);
/// ```
#[inline]
pub fn reference_power<T: Real>(offset: [T; 3], torque: [T; 3], reference_velocity: [T; 3]) -> T {
    -dot(torque, Quaternion::exp(offset).turn(reference_velocity))
}

/// A rotation vector no longer than `most` [rad], in the same direction: a cap on an offset that does not depend on the axes.
///
/// ```
/// use hpf_core::orientation::within_cone;
/// assert_eq!(within_cone([0.0, 3.0, 4.0], 1.0), [0.0, 0.6, 0.8]);
/// assert_eq!(within_cone([0.0, 0.3, 0.4], 1.0), [0.0, 0.3, 0.4]);
/// ```
#[inline]
pub fn within_cone<T: Real>(offset: [T; 3], most: T) -> [T; 3] {
    let angle = length(offset);
    offset.map(|part| most.choose_below(angle, || part * most / angle, || part))
}
