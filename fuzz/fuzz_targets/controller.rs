//! A controller for as long as the input lasts: a skill, settings, requests, forces, positions, rates and times out of it,
//! any bits among them. Whatever comes in, it keeps what the documentation promises (`play/promises.rs`), and the same
//! again gives the same bits. Two kinds of input keep to what a port asks of robot and environment (`play/port.rs`).
#![no_main]

mod play {
    pub mod draw;
    pub mod port;
    pub mod promises;
    pub mod still;
}

use hpf_core::controller::{Controller, Input, Request};
use libfuzzer_sys::arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use play::draw::{N, Scalar, Taste, each, number, settings, skill, worst};
use play::promises::{Witness, in_domain, lawful};

/// Updates of one input, at most.
const UPDATES: u32 = 20_000;

/// A request, sometimes.
fn request<T: Scalar, const D: usize>(input: &mut Unstructured<'_>, place: [T; D]) -> Result<Option<Request<T, D>>> {
    Ok(match u8::arbitrary(input)? % 16 {
        0..=2 => Some(Request::Start),
        3 => Some(Request::Hold),
        4 => Some(Request::Resume),
        5 => Some(Request::Stop),
        6 => Some(Request::Goal(place)),
        7 => Some(Request::Tare),
        8 | 9 => Some(Request::Reset(place)),
        _ => None,
    })
}

/// How many steps the same comes in.
fn repeats(input: &mut Unstructured<'_>) -> Result<u32> {
    let count = u32::from(u8::arbitrary(input)?);
    Ok(match count % 8 {
        0..=3 => 1,
        4..=6 => count / 4,
        _ => 8 * count,
    })
}

fn play<T: Scalar, const D: usize>(input: &mut Unstructured<'_>) -> Result<()> {
    let taste = Taste::draw(input)?;
    let Some(skill) = skill::<T, D>(input, taste)? else { return Ok(()) };
    let place = each(input, taste, -0.3, 0.3)?;
    let Ok(mut arm) = Controller::<T, [T; N], D>::new(skill, settings(input, taste)?, place) else { return Ok(()) };
    in_domain(arm.settings());
    lawful(skill.axes());
    let mut witness = Witness::new(&arm.output(), arm.settings(), skill.axes());
    let mut updates = 0;
    while !input.is_empty() && updates < UPDATES {
        let choice = u8::arbitrary(input)?;
        // Hostile for a while, or not.
        let hostile = if choice & 1 == 0 { Taste::Plain } else { Taste::Wild };
        if choice & 62 == 62 {
            let settings = settings(input, if choice & 64 == 0 { taste } else { Taste::Plain })?;
            let before = arm;
            let accepted = arm.set(settings).is_ok();
            assert_eq!(*arm.settings(), if accepted { settings } else { *before.settings() });
            in_domain(arm.settings());
            witness.changed(accepted, arm.settings(), &arm.output(), arm.counters());
        }
        let place = each(input, hostile, -0.45, 0.45)?;
        let mut given = Input {
            measured_force: each(input, hostile, -60.0, 60.0)?,
            force_age: if choice & 14 == 14 { u32::arbitrary(input)? % 12 } else { 0 },
            measured_position: None,
            rate: if choice & 12 == 12 { number(input, hostile, 0.0, 1.0)? } else { T::ONE },
            request: request(input, place)?,
        };
        // Where the robot is, seen from the command.
        let gap: Option<[T; D]> = if choice & 16 != 0 { Some(each(input, hostile, -0.01, 0.01)?) } else { None };
        let dt = match choice >> 5 {
            0 => worst(input)?,
            1 => number(input, hostile, 0.0, 0.03)?,
            _ => T::of(1e-3),
        };
        for _ in 0..repeats(input)? {
            given.measured_position = gap.map(|gap| {
                let mut at = gap;
                at.iter_mut().zip(&arm.output().axes).for_each(|(at, axis)| *at = axis.position + *at);
                at
            });
            let mut again = arm;
            let bias = arm.bias();
            let now = arm.update(&given, dt);
            // Whatever is kept is a number, or it would not equal itself.
            assert_eq!(again.update(&given, dt), now);
            assert!(again == arm && arm.output() == now);
            witness.saw(&given, dt, arm.settings(), skill.axes(), [bias, arm.bias()], &now, arm.counters());
            given.request = None;
            updates += 1;
        }
        let _ = arm.heavy_tool(dt);
    }
    Ok(())
}

fuzz_target!(|bytes: &[u8]| {
    let Some((&kind, rest)) = bytes.split_first() else { return };
    let input = &mut Unstructured::new(rest);
    let _ = match kind % 8 {
        0 => play::<f32, 1>(input),
        1 => play::<f32, 2>(input),
        2 => play::<f32, 7>(input),
        3 => play::<f64, 1>(input),
        4 => play::<f64, 2>(input),
        5 => play::<f64, 3>(input),
        6 => play::port::play::<1>(input),
        _ => play::port::play::<2>(input),
    };
});
