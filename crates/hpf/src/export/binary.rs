//! The packed skill of `hpf_core::packed`.

use hpf_core::packed::{Head, VERSION};
use hpf_sim::Policy;
use hpf_sim::task::Unit;

use super::{Precision, bases, masses};

/// The bytes of a policy that makes a skill in this scalar.
pub fn bytes(policy: &Policy, precision: Precision) -> Vec<u8> {
    let rotary = policy.axes.iter().enumerate().map(|(i, axis)| u16::from(axis.unit == Unit::Rad) << i).sum();
    let bases = bases(policy, precision);
    let head = Head {
        version: VERSION,
        scalar: precision.scalar(),
        axes: policy.axes.len() as u8,
        functions: bases.each_ref().map(|basis| basis.count() as u16),
        rotary,
        in_time: bases.each_ref().map(|basis| basis.overlap.is_some()),
    };
    let mut numbers = vec![policy.duration_s, policy.phase.decay];
    for basis in bases {
        numbers.extend(basis.centers);
        let first = numbers.len();
        numbers.extend(basis.shape);
        // What has fallen to 1 at no distance needs no place: the overlap takes it.
        numbers[first] = basis.overlap.unwrap_or(numbers[first]);
    }
    for (axis, mass) in policy.axes.iter().zip(masses(policy)) {
        let (movement, stiffness, damping) = (&axis.movement, &axis.stiffness, &axis.damping);
        numbers.extend([axis.start, axis.goal, movement.alpha, movement.forcing_scale]);
        numbers.extend(&movement.weights);
        for gain in [stiffness, damping] {
            numbers.extend([gain.min, gain.max]);
            numbers.extend(&gain.weights);
        }
        // The damping of a policy is its primitive: no ratio.
        numbers.extend([mass, 0.0, 0.0]);
    }
    let mut bytes = vec![0; head.length()];
    head.pack(numbers, &mut bytes).expect("a checked policy has at most 7 axes, 1000 functions, and finite numbers");
    bytes
}
