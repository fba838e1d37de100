//! Packed skills: what goes in comes out, and nothing damaged does.

use hpf_core::packed::{Contents, Head, Packed, PackedError, Scalar, VERSION, crc32};
use hpf_core::{Basis, ConfigError, Damping, HybridPrimitive, Law, Real};
use proptest::collection::vec;
use proptest::prelude::*;

/// Functions in the bases of movement, stiffness and damping.
const FUNCTIONS: [u16; 3] = [4, 3, 2];

/// A head and its numbers: two axes, each list another, each its law.
fn example(scalar: Scalar) -> (Head, Vec<f64>) {
    let head = Head { version: VERSION, scalar, axes: 2, functions: FUNCTIONS, rotary: 0b10, in_time: [false; 3] };
    let mut numbers = vec![1.7, 4.605];
    for count in FUNCTIONS.map(f64::from) {
        numbers.extend((0..count as usize).map(|i| 1.0 - i as f64 / count));
        numbers.extend((0..count as usize).map(|i| 3.1 + i as f64));
    }
    for axis in [1.0, -0.7] {
        numbers.extend([0.1 * axis, axis, 25.0, 0.9]);
        numbers.extend([30.3, -11.7, 8.1, 40.0]);
        numbers.extend([30.0, 400.0, 100.0 + axis, 200.0, 399.9]);
        numbers.extend([10.0, 100.0, 20.0 + axis, 55.5]);
        numbers.extend(if axis > 0.0 { [2.5, 0.0, 0.0] } else { [0.5, 0.7, 5.0] });
    }
    (head, numbers)
}

fn packed(scalar: Scalar) -> Vec<u8> {
    let (head, numbers) = example(scalar);
    let mut bytes = vec![0; head.length()];
    head.pack(numbers, &mut bytes).unwrap();
    bytes
}

/// The same bytes with a checksum that fits.
fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    let body = bytes.len() - 4;
    let sum = crc32(&bytes[..body]).to_le_bytes();
    bytes[body..].copy_from_slice(&sum);
    bytes
}

/// Reads bytes in every way there is; must not panic.
fn read(bytes: &[u8]) -> Result<(), PackedError> {
    let packed = Packed::parse(bytes)?;
    assert_eq!(packed.values::<f64>().count(), packed.head().numbers());
    let _ = packed.skill::<f32, 3, 1>();
    let _ = packed.skill::<f64, 2, 2>();
    let mut storage = vec![0.0; packed.head().storage()];
    let _ = packed.skill_in::<f32, 1>(&mut [0.0; 7]);
    match packed.head().axes {
        1 => packed.skill_in::<f64, 1>(&mut storage).map(drop),
        2 => packed.skill_in::<f64, 2>(&mut storage).map(drop),
        _ => Ok(()),
    }
}

#[test]
fn a_basis_of_the_time_family_is_packed_with_its_overlap_and_checked() {
    let basis = Basis::equally_spaced_in_time(4.605, 0.6, [0.0; 4], [0.0; 4]).unwrap();
    let head = Head { functions: [4; 3], in_time: [true, false, true], ..example(Scalar::Double).0 };
    let numbers = |overlap: f64| {
        let time = [basis.centers(), &[overlap], &basis.widths()[1..]].concat();
        let phase = [1.0, 0.7, 0.4, 0.1, 3.1, 3.2, 3.3, 3.4];
        let mut numbers = [&[1.7, 4.605][..], &time, &phase, &time].concat();
        for axis in [1.0, -0.7] {
            numbers.extend([0.1 * axis, axis, 25.0, 0.9, 30.3, -11.7, 8.1, 40.0]);
            numbers.extend([30.0, 400.0, 100.0, 200.0, 300.0, 390.0, 10.0, 100.0, 20.0, 30.0, 40.0, 50.0]);
            numbers.extend([0.0; 3]);
        }
        let mut bytes = vec![0; head.length()];
        head.pack(numbers, &mut bytes).unwrap();
        bytes
    };
    let bytes = numbers(0.6);
    let packed = Packed::parse(&bytes).unwrap();
    assert_eq!(packed.head(), &head);
    let skill = packed.skill::<f64, 4, 2>().unwrap();
    let weights = skill.axes()[1].damping.weights();
    for s in [1.0, 0.3, 0.05] {
        assert_eq!([skill.at(s)[1].damping], basis.mix(s, [weights]));
    }
    // The same lists under another overlap are those of no basis.
    let bytes = numbers(0.61);
    let refused = Packed::parse(&bytes).unwrap().skill::<f64, 4, 2>().unwrap_err();
    assert!(matches!(refused, PackedError::Config(ConfigError::OutOfRange { field: "falls", .. })), "{refused}");
}

#[test]
fn numbers_come_back_to_the_bit() {
    let (_, numbers) = example(Scalar::Double);
    let bytes = packed(Scalar::Double);
    let double = Packed::parse(&bytes).unwrap();
    assert_eq!(double.values::<f64>().collect::<Vec<_>>(), numbers);
    assert_eq!((double.head().rotary, double.head().functions), (0b10, FUNCTIONS));
    let bytes = packed(Scalar::Single);
    let single: Vec<f32> = Packed::parse(&bytes).unwrap().values().collect();
    assert_eq!(single, numbers.iter().map(|&number| number as f32).collect::<Vec<_>>());
}

#[test]
fn the_skill_has_each_list_in_its_place() {
    let bytes = packed(Scalar::Double);
    let mut storage = [0.0; 36];
    let skill: HybridPrimitive<f64, &[f64], 2> = Packed::parse(&bytes).unwrap().skill_in(&mut storage).unwrap();
    assert_eq!((skill.phase().duration(), skill.phase().decay()), (1.7, 4.605));
    let [_, axis] = skill.axes();
    let movement = &axis.movement;
    assert_eq!((movement.start(), movement.goal(), movement.alpha()), (0.1 * -0.7, -0.7, 25.0));
    assert_eq!((movement.forcing_scale(), movement.weights()), (0.9, &[30.3, -11.7, 8.1, 40.0][..]));
    assert_eq!((axis.stiffness.min(), axis.stiffness.max()), (30.0, 400.0));
    assert_eq!(axis.stiffness.weights(), [100.0 - 0.7, 200.0, 399.9]);
    assert_eq!((axis.damping.min(), axis.damping.max()), (10.0, 100.0));
    assert_eq!(axis.damping.weights(), [20.0 - 0.7, 55.5]);
    let laws = skill.axes().map(|axis| axis.law);
    let ratio = Damping::Ratio { ratio: 0.7, floor: 5.0 };
    let [first, second] = [(2.5, Damping::Primitive), (0.5, ratio)];
    assert_eq!(laws, [first, second].map(|(mass, damping)| Law::SecondOrder { mass, damping }));
}

#[test]
fn each_axis_is_read_number_by_number() {
    for scalar in [Scalar::Single, Scalar::Double] {
        let held = |number: f64| if scalar == Scalar::Single { f64::from(number as f32) } else { number };
        let bytes = packed(scalar);
        let packed = Packed::parse(&bytes).unwrap();
        assert_eq!((packed.duration(), packed.axes().count()), (held(1.7), 2));
        let axis = packed.axes().nth(1).unwrap();
        assert_eq!([axis.start, axis.goal, axis.alpha, axis.forcing_scale], [0.1 * -0.7, -0.7, 25.0, 0.9].map(held));
        assert!(axis.weights().eq([30.3, -11.7, 8.1, 40.0].map(held)) && axis.is_rotary);
        assert_eq!(
            [axis.stiffness.min, axis.stiffness.max, axis.damping.min, axis.damping.max],
            [30.0, 400.0, 10.0, 100.0]
        );
        assert!(axis.stiffness.weights().eq([100.0 - 0.7, 200.0, 399.9].map(held)));
        assert!(axis.damping.weights().eq([20.0 - 0.7, 55.5].map(held)));
        assert_eq!(axis.law, [0.5, 0.7, 5.0].map(held));
        assert!(!packed.axes().next().unwrap().is_rotary);
    }
}

/// Bytes of a skill of two axes, its bases of the families asked for, and the skill.
fn written<T: Real>(in_time: [bool; 3]) -> (Vec<u8>, HybridPrimitive<T, [T; 5], 2>) {
    let basis = |in_time: bool| {
        let make = if in_time { Basis::equally_spaced_in_time } else { Basis::equally_spaced };
        make(T::of(4.605), T::of(0.6), [T::ZERO; 5], [T::ZERO; 5]).unwrap()
    };
    let bytes = {
        let (head, functions) = (example(Scalar::Double).0, [5; 3]);
        let head = Head { functions, ..head };
        let mut numbers = vec![1.7, 4.605];
        numbers.extend((0..30).map(|i| if i % 10 < 5 { 1.0 - 0.1 * f64::from(i % 10) } else { 3.0 }));
        for axis in [1.0, -0.7] {
            numbers.extend([0.1 * axis, axis, 25.0, 0.9, 30.3, -11.7, 8.1, -0.0, 1e-12]);
            numbers.extend([30.0, 400.0, 100.0 + axis, 200.0, 399.9, 30.0, 31.0]);
            numbers.extend([10.0, 100.0, 20.0 + axis, 55.5, 10.0, 11.0, 12.0]);
            numbers.extend(if axis > 0.0 { [2.5, 0.0, 0.0] } else { [0.5, 0.7, 5.0] });
        }
        let mut bytes = vec![0; head.length()];
        head.pack(numbers, &mut bytes).unwrap();
        bytes
    };
    let axes = *Packed::parse(&bytes).unwrap().skill::<T, 5, 2>().unwrap().axes();
    let phase = hpf_core::Phase::new(T::of(1.7), T::of(4.605)).unwrap();
    let skill = HybridPrimitive::new(phase, in_time.map(basis), axes).unwrap();
    let contents = Contents::of(&skill, 0b10);
    let mut bytes = vec![0; contents.head().unwrap().length()];
    contents.pack(&mut bytes).unwrap();
    (bytes, skill)
}

#[test]
fn a_skill_comes_back_whole_from_its_bytes_in_both_scalars_and_families() {
    fn check<T: Real>(scalar: Scalar) {
        for families in 0..8 {
            let in_time = [1, 2, 4].map(|bit| families & bit != 0);
            let (bytes, skill) = written::<T>(in_time);
            let packed = Packed::parse(&bytes).unwrap();
            let head = Head { version: VERSION, scalar, axes: 2, functions: [5; 3], rotary: 0b10, in_time };
            assert_eq!(packed.head(), &head);
            assert_eq!(packed.skill::<T, 5, 2>().unwrap(), skill);
            // A weight of -0 is none of 0.
            let weights: Vec<u64> = packed.axes().next().unwrap().weights().map(f64::to_bits).collect();
            assert_eq!(weights[3], (-0.0_f64).to_bits());
        }
    }
    check::<f32>(Scalar::Single);
    check::<f64>(Scalar::Double);
}

#[test]
fn parts_that_no_packed_skill_can_have_are_refused_before_a_byte_is_written() {
    let (bytes, skill) = written::<f64>([false; 3]);
    let contents = Contents::of(&skill, 0);
    let mut out = [7; 9];
    let expected = bytes.len();
    assert_eq!(contents.pack(&mut out), Err(PackedError::Length { found: 9, expected }));
    let none = Contents { axes: &[], ..contents };
    assert_eq!(none.pack(&mut out), Err(PackedError::Axes { found: 0, expected: 16 }));
    let axes = [skill.axes()[0]; 300];
    let many = Contents { axes: &axes, ..contents };
    assert_eq!(many.pack(&mut out), Err(PackedError::Axes { found: 300, expected: 16 }));
    let lists = |count: usize| (0..count).map(|i| 1.0 - i as f64 / count as f64).collect::<Vec<f64>>();
    let basis = |count| Basis::new(lists(count), vec![1.0; count]).unwrap();
    let axis = skill.axes()[0];
    let axis = hpf_core::AxisPrimitives {
        movement: hpf_core::Movement::new(0.0, 1.0, 25.0, 1.0, lists(5)).unwrap(),
        stiffness: hpf_core::Gain::new(30.0, 400.0, vec![40.0; 5]).unwrap(),
        damping: hpf_core::Gain::new(10.0, 100.0, vec![40.0; 5]).unwrap(),
        law: axis.law,
    };
    let (five, six, huge) = (basis(5), basis(6), basis(70_000));
    let uneven =
        Contents { phase: skill.phase(), bases: [&five, &six, &five], axes: core::slice::from_ref(&axis), rotary: 0 };
    let refused = ConfigError::LengthMismatch { field: "stiffness.weights", found: 5, expected: 6 };
    assert_eq!(uneven.pack(&mut out), Err(PackedError::Config(refused)));
    let large = Contents { bases: [&huge, &five, &five], axes: core::slice::from_ref(&axis), ..uneven };
    assert_eq!(large.pack(&mut out), Err(PackedError::Functions { found: 70_000, expected: 65_535 }));
    assert_eq!(out, [7; 9]);
}

#[test]
fn version_1_is_read_and_written_and_is_of_first_order() {
    let (head, numbers) = example(Scalar::Double);
    let head = Head { version: 1, ..head };
    // Without the three numbers that end each axis.
    let [axis, law] = [(4 + 4) + (2 + 3) + (2 + 2), 3];
    let front = numbers.len() - 2 * (axis + law);
    let old: Vec<f64> = numbers[..front]
        .iter()
        .chain(&numbers[front..][..axis])
        .chain(&numbers[front + axis + law..][..axis])
        .copied()
        .collect();
    let mut bytes = vec![0; head.length()];
    head.pack(old.iter().copied(), &mut bytes).unwrap();
    assert_eq!((bytes[4], bytes.len()), (1, packed(Scalar::Double).len() - 2 * 3 * 8));
    let old = Packed::parse(&bytes).unwrap();
    assert_eq!(old.head(), &head);
    let mut storage = vec![0.0; head.storage()];
    let old = old.skill_in::<f64, 2>(&mut storage).unwrap();
    let bytes = packed(Scalar::Double);
    let mut storage = vec![0.0; head.storage()];
    let new = Packed::parse(&bytes).unwrap().skill_in::<f64, 2>(&mut storage).unwrap();
    assert_eq!(old, new.with_laws([Law::FirstOrder; 2]).unwrap());
    for version in [0, 3, u16::MAX] {
        let mut bytes = packed(Scalar::Double);
        bytes[4..6].copy_from_slice(&version.to_le_bytes());
        assert_eq!(Packed::parse(&sealed(bytes)), Err(PackedError::Version { found: version }));
        let head = Head { version, ..head };
        assert_eq!(head.pack([], &mut []), Err(PackedError::Version { found: version }));
    }
}

#[test]
fn what_does_not_fit_is_said() {
    let bytes = packed(Scalar::Double);
    let packed = Packed::parse(&bytes).unwrap();
    assert_eq!(packed.skill_in::<f64, 3>(&mut [0.0; 99]), Err(PackedError::Axes { found: 2, expected: 3 }));
    assert_eq!(packed.skill_in::<f64, 2>(&mut [0.0; 35]), Err(PackedError::Storage { found: 35, needed: 36 }));
    assert_eq!(packed.skill::<f64, 4, 2>(), Err(PackedError::Functions { found: 3, expected: 4 }));
    let (head, mut numbers) = example(Scalar::Single);
    let mut out = vec![0; head.length()];
    let expected = head.numbers();
    assert_eq!(head.pack(numbers[1..].iter().copied(), &mut out), Err(PackedError::Numbers { expected }));
    let more = numbers.iter().copied().chain([0.0]);
    assert_eq!(head.pack(more, &mut out), Err(PackedError::Numbers { expected }));
    assert!(matches!(head.pack(numbers.clone(), &mut out[1..]), Err(PackedError::Length { .. })));
    numbers[3] = 1e300; // no number of single precision
    assert!(matches!(head.pack(numbers, &mut out), Err(PackedError::Config(ConfigError::NotFinite { .. }))));
}

#[test]
fn a_number_that_cannot_be_is_refused_though_its_checksum_fits() {
    // Among them a law of its last axis: no mass, a mass that is none, too little of it, a floor without its ratio.
    let law = example(Scalar::Double).1.len() - 3;
    for (place, wrong) in [
        (0, -1.0),
        (2, 0.0),
        (28, 0.0),
        (30, 1e9),
        (30, f64::NAN),
        (50, 1e9),
        (law, 0.0),
        (law, -1.0),
        (law, f64::NAN),
        (law, 1e-10),
        (law + 1, 0.0),
        (law + 1, -0.1),
        (law + 2, 0.0),
    ] {
        let mut bytes = packed(Scalar::Double);
        bytes[16 + 8 * place..][..8].copy_from_slice(&wrong.to_le_bytes());
        let refused = read(&sealed(bytes));
        assert!(matches!(refused, Err(PackedError::Config(_))), "{place}: {refused:?}");
    }
}

#[test]
fn every_damaged_byte_is_refused() {
    for scalar in [Scalar::Single, Scalar::Double] {
        let whole = packed(scalar);
        Packed::parse(&whole).unwrap();
        for place in 0..whole.len() {
            for damage in 1..=255 {
                let mut bytes = whole.clone();
                bytes[place] ^= damage;
                assert!(Packed::parse(&bytes).is_err(), "byte {place} xor {damage}");
            }
        }
    }
}

#[test]
fn every_cut_and_every_added_byte_is_refused() {
    for scalar in [Scalar::Single, Scalar::Double] {
        let whole = packed(scalar);
        for length in 0..whole.len() {
            assert!(Packed::parse(&whole[..length]).is_err(), "cut to {length}");
            assert!(Packed::parse(&sealed([&whole[..length], &[0; 4]].concat())).is_err() || length + 4 == whole.len());
        }
        for more in 0..=255 {
            assert!(Packed::parse(&[&whole[..], &[more]].concat()).is_err());
        }
    }
}

proptest! {
    #[test]
    fn arbitrary_bytes_do_not_panic(bytes in vec(any::<u8>(), 0..600)) {
        prop_assert!(read(&bytes).is_err());
    }

    #[test]
    fn arbitrary_numbers_under_a_checksum_that_fits_do_not_panic(
        wide in any::<bool>(),
        newer in any::<bool>(),
        axes in 1_u8..4,
        functions in [0_u16..5, 0..5, 0..5],
        noise in vec(any::<f64>(), 1..40),
    ) {
        let scalar = if wide { Scalar::Double } else { Scalar::Single };
        let head = Head { version: 1 + u16::from(newer), scalar, axes, functions, rotary: 0, in_time: [false; 3] };
        let mut bytes = vec![0; head.length()];
        head.pack(vec![0.5; head.numbers()], &mut bytes).unwrap();
        let last = bytes.len() - 4;
        for (slot, byte) in bytes[16..last].iter_mut().zip(noise.iter().flat_map(|x| x.to_le_bytes()).cycle()) {
            *slot = byte;
        }
        let _ = read(&sealed(bytes));
    }
}
