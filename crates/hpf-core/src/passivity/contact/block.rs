//! A mass behind the spring of a contact.
//!
//! The tool at y presses by K and C on a free mass m at x: `m x'' = K s + C s'`, `s = y - x`, so that
//! `m s'' + C s' + K s = m y''`: the law of second order, pushed by the robot's acceleration. Within a step the command's
//! velocity w is held and the robot follows by `y'' = (w - v) exp(-t/T)/T`, v its velocity at the start. Over a step
//! `S+ = P S + g (w - v)` for `S = (s, s')`, exact: `g(2h) = P(h) g(h) + exp(-h/T) g(h)` doubles a step so short that its
//! series ends.

use super::circle::{Angle, Complex};
use crate::ConfigError;
use crate::admittance::{Inertial, OffsetMotion};

/// Damping ratio that a spring has at least: without any, an open loop has poles on the circle.
const LEAST_RATIO: f64 = 1e-6;

/// Halvings of the step to where `g` is the first terms of its series.
const HALVINGS: i32 = 30;

/// The mass behind the spring, over one step.
pub(super) struct Block {
    stiffness: f64,
    damping: f64,
    mass: f64,
    /// G1 and G2 of the step.
    response: [f64; 2],
    /// g.
    push: [f64; 2],
}

impl Block {
    /// A `mass` [kg] behind `stiffness` [N/m] and `damping` [N s/m] over `dt` [s], the robot late by `lag` [s].
    pub(super) fn new(mass: f64, stiffness: f64, damping: f64, dt: f64, lag: f64) -> Result<Self, ConfigError> {
        let damping = damping.max(2.0 * LEAST_RATIO * libm::sqrt(stiffness * mass));
        let law = Inertial::new(mass, stiffness, damping, dt)?;
        let after = |mut motion: OffsetMotion<f64>, force: f64, dt: f64| {
            law.step(&mut motion, stiffness, damping, force, dt);
            [motion.offset, motion.velocity]
        };
        let rest = OffsetMotion { offset: 0.0, velocity: 0.0 };
        let push = if lag > 0.0 {
            let mut h = libm::scalbn(dt, -HALVINGS);
            let (x, double_a) = (h / lag, damping / mass);
            let mut push = [0.5 * x * h, x * (1.0 - 0.5 * (x + double_a * h))];
            for _ in 0..HALVINGS {
                let [offset, velocity] = push;
                let [a, b] = after(OffsetMotion { offset, velocity }, 0.0, h);
                let left = libm::exp(-h / lag);
                push = [a + left * offset, b + left * velocity];
                h *= 2.0;
            }
            push
        } else {
            after(OffsetMotion { velocity: 1.0, ..rest }, 0.0, dt)
        };
        let response = after(rest, mass, dt);
        Ok(Self { stiffness, damping, mass, response, push })
    }

    /// Compression of the spring and its rate, for a difference of velocities w - v.
    pub(super) fn compressed(&self, at: &Angle, difference: Complex) -> [Complex; 2] {
        let real = Complex::real;
        let ([g1, g2], [s, rate]) = (self.response, self.push);
        let (w2, double_a) = (self.stiffness / self.mass, self.damping / self.mass);
        let held = at.less_one + real(w2 * g1);
        let slowed = held + real(double_a * g2);
        let per = difference / (held * slowed + real(w2 * g2 * g2));
        [per * (slowed * real(s) + real(g2 * rate)), per * (held * real(rate) + real(-w2 * g2 * s))]
    }

    /// Damping of the spring [N s/m].
    pub(super) fn damping(&self) -> f64 {
        self.damping
    }
}
