//! Certificates: what a schedule of gains can do at worst, before it runs.

use core::f64::consts::FRAC_PI_4;

use crate::admittance::step_offset;

/// The first time [s] at which the law `d e' + k e = f` is not passive from rest, if there is one. `gains` are stiffness
/// [N/m] and damping [N s/m] of steps of `dt` [s], each held over its step.
///
/// A tool that starts at rest never gives more than it was given iff `p' = -(k - p)^2/(2 d)`, `p(0) = +inf`, stays
/// above zero: `p e^2/2` is the least energy that must have been put in to be at e. Exact step for held gains:
/// `q = p - k`, `q <- q/(1 + q h/(2 d))`; a denominator of zero or less is an escape to minus infinity.
///
/// It decides for `m e'' + d e' + k e = f` too, whatever the mass: `int f e' = m v^2/2 + k e^2/2 + int (d v^2 - k' e^2/2)`,
/// and the mass adds to the least of it only `m v^2/2`, which is zero at rest.
///
/// ```
/// use hpf_core::passivity::first_order_fails_at;
/// assert_eq!(first_order_fails_at([(100.0, 50.0); 1000], 0.01), None); // constant gains
/// let jump = (0..20).map(|i| (if i < 10 { 30.0 } else { 400.0 }, 10.0)); // by 370 N/m after 2.5 s
/// assert_eq!(first_order_fails_at(jump, 0.25), Some(2.75)); // at the end of the first stiff step
/// ```
pub fn first_order_fails_at(gains: impl IntoIterator<Item = (f64, f64)>, dt: f64) -> Option<f64> {
    let mut p = f64::INFINITY;
    for (step, (stiffness, damping)) in gains.into_iter().enumerate() {
        let halved = dt / (2.0 * damping);
        let q = p - stiffness;
        let left = 1.0 + q * halved;
        p = stiffness + if q == f64::INFINITY { 1.0 / halved } else { q / left };
        if !(left > 0.0 && p >= 0.0) {
            return Some((step + 1) as f64 * dt);
        }
    }
    None
}

/// A decay a [1/s] that proves the free motion `m e'' + d e' + k e = 0` stable over a schedule, the largest, if there is
/// one. Passivity is another matter, which [`first_order_fails_at`] decides.
///
/// Sufficient (Kronander and Billard, IEEE T-RO 32(5):1298, 2016, doi 10.1109/TRO.2016.2593492): one a > 0 with
/// `d >= a m` and `k' + a d' <= 2 a k` all along. `gains` are stiffness [N/m] and damping [N s/m] every `dt` [s].
///
/// ```
/// use hpf_core::passivity::inertial_decay;
/// assert_eq!(inertial_decay([(100.0, 50.0); 10], 2.0, 0.01), Some(25.0)); // constant gains: a = d/m
/// assert_eq!(inertial_decay([(30.0, 10.0), (400.0, 10.0)], 2.0, 0.01), None); // a jump
/// ```
pub fn inertial_decay(gains: impl IntoIterator<Item = (f64, f64)>, mass: f64, dt: f64) -> Option<f64> {
    let (mut least, mut most) = (0.0_f64, f64::INFINITY);
    let mut last = None;
    for (stiffness, damping) in gains {
        most = most.min(damping / mass);
        if let Some((k, d)) = last.replace((stiffness, damping)) {
            // k' <= a (2 k - d'), with the smaller k of the two ends.
            let (rise, room) = ((stiffness - k) / dt, 2.0 * stiffness.min(k) - (damping - d) / dt);
            if room > 0.0 {
                least = least.max(rise / room);
            } else if room < 0.0 {
                most = most.min(rise / room);
            } else if rise > 0.0 {
                return None;
            }
        }
    }
    (most > 0.0 && most >= least).then_some(most)
}

/// The most energy [J] that switching through `stiffness` [N/m] in turn can put in while the offset stays within
/// `offset` [m]: `sum max(0, k_{i+1} - k_i) offset^2/2`.
///
/// ```
/// use hpf_core::passivity::switched_energy;
/// let cycle = switched_energy([30.0, 400.0, 30.0], 0.1);
/// assert!((cycle - 1.85).abs() < 1e-12); // 370 N/m at 0.1 m
/// ```
pub fn switched_energy(stiffness: impl IntoIterator<Item = f64>, offset: f64) -> f64 {
    let mut stiffness = stiffness.into_iter();
    let Some(mut last) = stiffness.next() else { return 0.0 };
    let mut risen = 0.0;
    for next in stiffness {
        risen += (next - last).max(0.0);
        last = next;
    }
    0.5 * risen * offset * offset
}

/// The largest offset [m] that any force of at most `force` [N] can bring about from rest, with gains as in
/// [`first_order_fails_at`].
///
/// The law is linear in e, and an earlier push only ever adds: the worst force is `force` all along. Not above
/// `force` over the least stiffness.
///
/// ```
/// use hpf_core::passivity::largest_offset;
/// let offset = largest_offset([(100.0, 10.0); 1000], 20.0, 0.01); // 100 time constants
/// assert!((offset - 0.2).abs() < 1e-12); // f/k
/// ```
pub fn largest_offset(gains: impl IntoIterator<Item = (f64, f64)>, force: f64, dt: f64) -> f64 {
    let offsets = gains.into_iter().scan(0.0, |offset, (stiffness, damping)| {
        *offset = step_offset(*offset, stiffness, damping, force, dt);
        Some(*offset)
    });
    offsets.fold(0.0, f64::max)
}

/// The stiffness [N/m] of a contact from which on the loop through its measured force may be unstable: the tool of the
/// law `d e' + k e = f`, with `damping` d [N s/m] or more, held over steps of `dt` [s], the force `delay` [s] old.
///
/// `K_e < (2 d/h) sin(pi h/(4 (delay + h/2)))`: exact for whole steps of delay and k = 0, where `e+ = e - (K_e h/d) e_{-n}`
/// first has a root on the unit circle; cautious for k > 0 and between steps. For delays of many steps it is
/// `(pi/2) d/(delay + h/2)`, the limit of the continuous law; at one step that is 5 % too much, without delay 57 %.
/// [`ForceLoop`](super::ForceLoop) has tool, filter, lag and the masses of law and contact.
///
/// ```
/// use hpf_core::passivity::contact_stiffness_limit;
/// let limit = contact_stiffness_limit(50.0, 0.001, 0.001);
/// assert!((limit - 50_000.0).abs() < 1e-6); // one step late: d/h
/// ```
pub fn contact_stiffness_limit(damping: f64, delay: f64, dt: f64) -> f64 {
    2.0 * damping / dt * libm::sin(FRAC_PI_4 * dt / (delay + 0.5 * dt))
}
