//! The packed skill of `hpf_core::packed`.

use hpf_core::Real;
use hpf_core::packed::Contents;
use hpf_sim::Policy;
use hpf_sim::task::Unit;

use super::Precision;

/// The bytes of a policy that makes a skill in this scalar.
pub fn bytes(policy: &Policy, precision: Precision) -> Vec<u8> {
    match precision {
        Precision::F32 => bytes_of::<f32>(policy),
        Precision::F64 => bytes_of::<f64>(policy),
    }
}

fn bytes_of<T: Real>(policy: &Policy) -> Vec<u8> {
    const CHECKED: &str = "a policy that makes a skill has its parts";
    let (phase, bases) = (policy.phase::<T>().expect(CHECKED), policy.bases::<T>().expect(CHECKED));
    let contents = Contents {
        phase: &phase,
        bases: bases.each_ref(),
        axes: &policy.primitives().expect(CHECKED),
        rotary: policy.axes.iter().enumerate().map(|(i, axis)| u16::from(axis.unit == Unit::Rad) << i).sum(),
    };
    const FITS: &str = "a checked policy has at most 7 axes, 1000 functions, and finite numbers";
    let mut bytes = vec![0; contents.head().expect(FITS).length()];
    contents.pack(&mut bytes).expect(FITS);
    bytes
}
