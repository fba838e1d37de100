//! The continuous-time equations, solved from the numbers of a policy alone: an own phase, basis, movement equation
//! (Runge-Kutta 4), beam and tool law (Radau IIA of two stages, third order and L-stable: the contact at the clamp
//! relaxes within 1e-4 s). No kernel of the library is used. The end-to-end tests use it too.

pub mod mixture;

use hpf_sim::{AxisPolicy, GainPolicy, Policy};
use mixture::mixture;

fn gain(s: f64, gain: &GainPolicy) -> f64 {
    mixture(s, &gain.centers, &gain.widths, &gain.weights)
}

/// What acts on the tool besides the admittance's own spring and damper: the force `b(t) - K_e(t) y`.
pub struct Load {
    force: fn(f64) -> f64,
    stiffness: fn(f64) -> f64,
    start: f64,
}

/// Reference position, its velocity, and the tool's position at `samples` + 1 times, `finer` steps between them.
pub fn solve(policy: &Policy, axis: &AxisPolicy, load: &Load, samples: usize, finer: usize) -> Vec<[f64; 3]> {
    let duration = policy.duration_s;
    let phase = |t: f64| (-policy.phase.decay * t / duration).exp();
    let m = &axis.movement;
    let forcing = |t: f64| phase(t) * m.forcing_scale * mixture(phase(t), &m.centers, &m.widths, &m.weights);
    let acceleration =
        |x: f64, v: f64, f: f64| (m.alpha * (m.beta * (axis.goal - x) - duration * v) + f) / (duration * duration);
    let third = duration / (samples * finer * 3) as f64;
    let mut reference = [load.start, 0.0];
    let mut force_now = forcing(0.0);
    // One step of Runge-Kutta 4 over a third of the tool's step: the stages of the tool lie on its ends.
    let mut advance = |reference: &mut [f64; 2], t: f64| {
        let (h, [x, v]) = (third, *reference);
        let (middle, end) = (forcing(t + 0.5 * h), forcing(t + h));
        let a1 = acceleration(x, v, force_now);
        let (v2, a2) = (v + 0.5 * h * a1, acceleration(x + 0.5 * h * v, v + 0.5 * h * a1, middle));
        let (v3, a3) = (v + 0.5 * h * a2, acceleration(x + 0.5 * h * v2, v + 0.5 * h * a2, middle));
        let (v4, a4) = (v + h * a3, acceleration(x + h * v3, v + h * a3, end));
        *reference = [x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4), v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4)];
        force_now = end;
    };

    // y' = drive - rate y, at one time.
    let law = |t: f64, [x, v]: [f64; 2]| {
        let (k, d) = (gain(phase(t), &axis.stiffness), gain(phase(t), &axis.damping));
        ((k * x + d * v + (load.force)(t)) / d, (k + (load.stiffness)(t)) / d)
    };
    let mut tool = load.start;
    let mut found = vec![[reference[0], reference[1], tool]];
    for i in 0..samples * finer {
        let t = 3.0 * third * i as f64;
        advance(&mut reference, t);
        let (b1, l1) = law(t + third, reference);
        advance(&mut reference, t + third);
        advance(&mut reference, t + 2.0 * third);
        let (b2, l2) = law(t + 3.0 * third, reference);
        // Stages Y1 = y + h (5 f1 - f2)/12, Y2 = y + h (9 f1 + 3 f2)/12; the step ends at Y2.
        let h = 3.0 * third / 12.0;
        let (m11, m12, r1) = (1.0 + 5.0 * h * l1, -h * l2, tool + h * (5.0 * b1 - b2));
        let (m21, m22, r2) = (9.0 * h * l1, 1.0 + 3.0 * h * l2, tool + h * (9.0 * b1 + 3.0 * b2));
        tool = (m11 * r2 - m21 * r1) / (m11 * m22 - m21 * m12);
        if (i + 1) % finer == 0 {
            found.push([reference[0], reference[1], tool]);
        }
    }
    found
}

const BEAM_DURATION: f64 = 5.0;
/// E I of the paper's steel beam [N m^2].
const BENDING: f64 = 200e9 * 0.05 * 0.004 * 0.004 * 0.004 / 12.0;

fn along(t: f64) -> f64 {
    let u = t / BEAM_DURATION;
    0.8 * (10.0 * u.powi(3) - 15.0 * u.powi(4) + 6.0 * u.powi(5))
}

/// Stiffness of the beam of the tip-load curve: compliances of beam and contact in series.
pub fn tip_load(t: f64) -> f64 {
    let x = along(t);
    1.0 / (x * x * (3.0 * 0.8 - x) / (6.0 * BENDING) + 1e-6)
}

/// Stiffness of the beam loaded where the tool is.
pub fn moving_load(t: f64) -> f64 {
    1.0 / (along(t).powi(3) / (3.0 * BENDING) + 1e-6)
}

/// The paper's beam, for one of its two stiffnesses.
pub fn beam(stiffness: fn(f64) -> f64) -> Load {
    // The tool starts where the contact holds it: 10 N on 1e6 N/m.
    Load { force: |_| 10.0, stiffness, start: 1e-5 }
}

/// The via-point task's push and pull on either axis.
pub fn swing() -> Load {
    Load { force: |t| 10.0 * (2.0 * core::f64::consts::PI * t / 5.0).sin(), stiffness: |_| 0.0, start: 0.0 }
}

/// Largest distance of a signal from a column of the solution.
pub fn distance(signal: &[f64], solution: &[[f64; 3]], column: usize) -> f64 {
    // The solution is that of the movement; the signal goes on over the rest time.
    assert!(signal.len() >= solution.len());
    signal.iter().zip(solution).map(|(a, b)| (a - b[column]).abs()).fold(0.0, f64::max)
}
