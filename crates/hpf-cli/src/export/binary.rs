//! The packed skill of `hpf_core::packed`.

use hpf_core::packed::Head;
use hpf_sim::Policy;
use hpf_sim::task::Unit;

use super::{Precision, bases, functions};

/// The bytes of a policy that makes a skill in this scalar.
pub fn bytes(policy: &Policy, precision: Precision) -> Vec<u8> {
    let rotary = policy.axes.iter().enumerate().map(|(i, axis)| u16::from(axis.unit == Unit::Rad) << i).sum();
    let head = Head {
        scalar: precision.scalar(),
        axes: policy.axes.len() as u8,
        functions: functions(policy).map(|count| count as u16),
        rotary,
    };
    let mut numbers = vec![policy.duration_s, policy.phase.decay];
    for (_, centers, widths) in bases(policy) {
        numbers.extend(centers.iter().chain(widths));
    }
    for axis in &policy.axes {
        let (movement, stiffness, damping) = (&axis.movement, &axis.stiffness, &axis.damping);
        numbers.extend([axis.start, axis.goal, movement.alpha, movement.forcing_scale]);
        numbers.extend(&movement.weights);
        for gain in [stiffness, damping] {
            numbers.extend([gain.min, gain.max]);
            numbers.extend(&gain.weights);
        }
    }
    let mut bytes = vec![0; head.length()];
    head.pack(numbers, &mut bytes).expect("a checked policy has at most 7 axes, 1000 functions, and finite numbers");
    bytes
}
