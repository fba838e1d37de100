//! How long a force has stood still, by the readings that went in: when a tare must be taken, when refused, and what it may
//! find.

use std::collections::VecDeque;

use hpf_core::Real;
use hpf_core::controller::{Input, Mode, Output, Settings};

use super::draw::Scalar;
use super::promises::{rounding, weight};

/// The force that was read, where all of it is good [N].
fn good_reading<T: Scalar, const D: usize>(input: &Input<T, D>, settings: &Settings<T, D>) -> Option<[f64; D]> {
    let is_good = input.force_age <= settings.timing.oldest_force && input.measured_force.iter().all(|f| f.is_finite());
    is_good.then(|| input.measured_force.map(|force| force.to_f64().clamp(-1e9, 1e9)))
}

/// The good readings in a row since the controller is in Idle [N], and how long each lasted [s], the newest first.
#[derive(Default)]
pub struct Still<const D: usize> {
    readings: VecDeque<([f64; D], f64)>,
}

impl<const D: usize> Still<D> {
    /// The readings that may still be known: those of three spans of a quarter of a second and ten readings at least.
    fn known(&self) -> impl Iterator<Item = &([f64; D], f64)> {
        let (mut spans, mut count, mut time) = (0, 0, 0.0);
        self.readings.iter().take_while(move |(_, h)| {
            let known = spans < 3;
            (count, time) = (count + 1, time + h);
            if count >= 10 && time > 0.251 {
                (spans, count, time) = (spans + 1, 0, 0.0);
            }
            known
        })
    }

    /// Whether a tare must be taken: this reading is good and within 5 % of all that may still be known. Where it is so
    /// of the last half second alone, or rounding decides, either answer is right.
    pub fn is_steady<T: Scalar>(
        &self,
        input: &Input<T, D>,
        settings: &Settings<T, D>,
        bias: [T; D],
        now: &Output<T, D>,
    ) -> bool {
        let Some(force) = good_reading(input, settings) else { return false };
        let ([mut may, mut must], mut age) = ([true; 2], 0.0);
        for (reading, h) in self.known() {
            for (i, axis) in settings.axes.iter().enumerate() {
                let (width, level) = ((reading[i] - force[i]).abs(), 0.05 * axis.limits.force.to_f64());
                let doubt = rounding::<T>(&[reading[i], force[i], bias[i].to_f64(), weight(settings, i), level]);
                may &= age > 0.499 || width <= level + doubt;
                must &= width <= level - doubt;
            }
            age += h;
        }
        must || may && !now.status.refused
    }

    /// What a tare has called zero is among the readings that may still be known.
    pub fn tared<T: Scalar>(&self, settings: &Settings<T, D>, bias: [T; D]) {
        for (i, bias) in bias.iter().map(|bias| bias.to_f64()).enumerate() {
            let all = self.known().map(|(reading, _)| reading[i]);
            let (least, most) =
                all.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), one| (least.min(one), most.max(one)));
            let found = bias + weight(settings, i);
            let doubt = 64.0 * rounding::<T>(&[bias, weight(settings, i), least, most]);
            assert!(found >= least - doubt && found <= most + doubt, "{found:e} is not in [{least:e}, {most:e}]");
        }
    }

    /// How long the force has stood still, seen from here.
    pub fn stand<T: Scalar>(&mut self, input: &Input<T, D>, settings: &Settings<T, D>, h: f64, now: &Output<T, D>) {
        assert!(!now.status.tare_ready || now.mode == Mode::Idle && h > 0.0);
        match good_reading(input, settings).filter(|_| now.mode == Mode::Idle && h > 0.0) {
            None => self.readings.clear(),
            Some(force) => {
                if now.status.long_time {
                    self.readings.clear();
                }
                self.readings.push_front((force, h));
            }
        }
    }
}
