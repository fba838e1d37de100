//! What the record of a motion shows of it: position and force with noise. The motion itself is as it is.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt as _, SeedableRng as _};
use rand_distr::StandardNormal;

use hpf_learn::Parameters;

use super::Simulation;
use crate::trace::Trace;

/// Records draw from streams of their own.
const STREAM: u64 = 0x9D5B_2C71_E604_A38F;

/// Mixes numbers into one (SplitMix64).
fn mixed(numbers: impl IntoIterator<Item = u64>) -> u64 {
    numbers.into_iter().fold(STREAM, |hash, number| {
        let mut mixed = (hash ^ number).wrapping_add(0x9E37_79B9_7F4A_7C15);
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        mixed ^ (mixed >> 31)
    })
}

impl Simulation {
    /// Whether records show anything but the motion itself.
    pub(crate) fn records_noise(&self) -> bool {
        self.task.recording.as_ref().is_some_and(|recording| {
            [&recording.position_noise, &recording.force_noise]
                .iter()
                .any(|noise| noise.values().iter().any(|x| *x > 0.0))
        })
    }

    /// Makes of the motion in `trace` its record; the same for the same `numbers`.
    pub(crate) fn add_record_noise(&self, trace: &mut Trace, numbers: [u64; 2]) {
        let Some(recording) = self.task.recording.as_ref().filter(|_| self.records_noise()) else { return };
        let seed = mixed([self.task.learning.seed].into_iter().chain(numbers));
        let mut generator = ChaCha8Rng::seed_from_u64(seed);
        for (a, axis) in trace.axes.iter_mut().enumerate() {
            let touched = self.touched().filter(|touched| touched.0 == a).map(|touched| touched.1);
            let deviations = [recording.position_noise.of(a), recording.force_noise.of(a)];
            for i in 0..axis.position.len() {
                let [position, force] = deviations.map(|sigma| sigma * generator.sample::<f64, _>(StandardNormal));
                axis.position[i] += position;
                axis.force[i] += force;
                if let (Some(direction), Some(contact)) = (touched, &mut trace.contact) {
                    contact.deviation[i] += direction * position;
                    contact.force[i] -= direction * force;
                }
            }
        }
    }

    /// The numbers of a record of which nothing is known but its parameters.
    pub(crate) fn numbers_of(parameters: Parameters<'_>, draw: usize) -> [u64; 2] {
        [mixed(parameters.at(0).iter().map(|weight| weight.to_bits())), draw as u64]
    }
}
