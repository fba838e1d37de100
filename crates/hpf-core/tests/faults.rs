//! Bad inputs, one by one and pair by pair: each becomes a fault within its time, whatever the others do.

use crate::support::{DT, Family, Rig, settings};
use hpf_core::controller::{Mode, Output, Request, Settings};
use hpf_core::limits::Hits;

type Arm = Rig<f64, 2>;

/// An input that can go bad.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Clock,
    LongClock,
    Force,
    StaleForce,
    Position,
    Rate,
}

const SOURCES: [Source; 6] =
    [Source::Clock, Source::LongClock, Source::Force, Source::StaleForce, Source::Position, Source::Rate];

/// Bad in the first `bad` of every `of` ticks.
#[derive(Clone, Copy, Debug)]
struct Pattern {
    bad: usize,
    of: usize,
}

const PATTERNS: [Pattern; 4] =
    [Pattern { bad: 1, of: 1 }, Pattern { bad: 19, of: 20 }, Pattern { bad: 1, of: 2 }, Pattern { bad: 1, of: 4 }];

impl Pattern {
    fn is_bad(self, tick: usize) -> bool {
        tick % self.of < self.bad
    }

    /// Of a tick, what is owed more after it than before, in the mean: bad ticks in full, good ones pay a quarter.
    fn owed_per_tick(self) -> f64 {
        let share = self.bad as f64 / self.of as f64;
        share - (1.0 - share) / 4.0
    }
}

/// One tick with `sources` bad.
fn tick(arm: &mut Arm, sources: &[Source]) -> Output<f64, 2> {
    let bad = |source| sources.contains(&source);
    let at = arm.controller.output().axes.map(|axis| axis.position);
    arm.input.measured_force = [1.0, if bad(Source::Force) { f64::NAN } else { 0.5 }];
    arm.input.force_age = if bad(Source::StaleForce) { 1000 } else { 0 };
    arm.input.measured_position = Some([at[0], if bad(Source::Position) { f64::INFINITY } else { at[1] }]);
    arm.input.rate = if bad(Source::Rate) { f64::NAN } else { 1.0 };
    arm.dt = match () {
        () if bad(Source::Clock) => f64::NAN,
        () if bad(Source::LongClock) => 1.0,
        () => DT,
    };
    arm.step()
}

/// The most ticks to a fault: what is owed reaches the limit, then the rate falls to zero by the ramp.
fn limit(source: Source, pattern: Pattern, settings: &Settings<f64, 2>) -> f64 {
    let timing = &settings.timing;
    let ramp = timing.ramp / DT;
    let to_be_lost = match source {
        Source::Clock | Source::LongClock => 20.0,
        _ => timing.hold / DT,
    };
    to_be_lost / pattern.owed_per_tick() + ramp + 3.0 * pattern.of as f64
}

fn moving(mode: Mode) -> Arm {
    let mut arm = Arm::started(Family::Time, settings(), 2.0);
    arm.run(0.5);
    match mode {
        Mode::Hold => drop(arm.ask(Request::Hold)),
        Mode::Stop => drop(arm.ask(Request::Stop)),
        _ => {}
    }
    arm
}

#[test]
fn each_input_that_stays_bad_becomes_a_fault_in_time_in_every_mode() {
    for mode in [Mode::Run, Mode::Hold, Mode::Stop] {
        for source in SOURCES {
            for pattern in PATTERNS {
                let mut arm = moving(mode);
                let most = limit(source, pattern, arm.controller.settings()) as usize;
                let bad = |tick| if pattern.is_bad(tick) { vec![source] } else { vec![] };
                let fault = (0..most).find(|&i| tick(&mut arm, &bad(i)).mode == Mode::Fault);
                assert!(fault.is_some(), "{source:?} {pattern:?} in {mode:?}: no fault in {most} ticks");
                assert_eq!(arm.controller.counters().faults, 1);
                // It stays one, and the arm stays where it is, whatever comes back.
                let at = arm.controller.output().axes.map(|axis| axis.position);
                for i in 0..3000 {
                    tick(&mut arm, &bad(i));
                }
                let output = arm.controller.output();
                assert_eq!((output.mode, output.axes.map(|axis| axis.position)), (Mode::Fault, at), "{source:?}");
                assert_eq!((output.rate, output.axes.map(|axis| axis.velocity)), (0.0, [0.0; 2]));
            }
        }
    }
}

#[test]
fn each_pair_of_inputs_becomes_a_fault_as_soon_as_the_faster_of_the_two() {
    for one in SOURCES {
        for other in SOURCES.into_iter().filter(|&other| other != one) {
            for (a, b) in PATTERNS.into_iter().flat_map(|a| PATTERNS.map(|b| (a, b))) {
                let mut arm = moving(Mode::Run);
                // A bad dt stops time for the others, a long one makes it run: then the clock's own limit counts.
                let timeless = |source| matches!(source, Source::Clock | Source::LongClock);
                let least = match (timeless(one), timeless(other)) {
                    (true, _) => limit(one, a, arm.controller.settings()),
                    (_, true) => limit(other, b, arm.controller.settings()),
                    _ => limit(one, a, arm.controller.settings()).min(limit(other, b, arm.controller.settings())),
                };
                let fault = (0..least as usize).find(|&i| {
                    let mut bad = vec![];
                    if a.is_bad(i) {
                        bad.push(one);
                    }
                    // The other's bad ticks lie elsewhere.
                    if b.is_bad(i + 1) {
                        bad.push(other);
                    }
                    tick(&mut arm, &bad).mode == Mode::Fault
                });
                assert!(fault.is_some(), "{one:?} {a:?} and {other:?} {b:?}: no fault in {least} ticks");
            }
        }
    }
}

#[test]
fn an_input_that_is_seldom_bad_is_none() {
    for source in SOURCES {
        let mut arm = moving(Mode::Run);
        for i in 0..100_000 {
            let bad = if i % 10 == 0 { vec![source] } else { vec![] };
            assert_eq!(tick(&mut arm, &bad).mode, Mode::Run, "{source:?} at tick {i}");
        }
    }
}

#[test]
fn a_loss_that_ends_in_time_goes_on() {
    for source in [Source::Force, Source::StaleForce, Source::Position, Source::Rate] {
        let mut arm = moving(Mode::Run);
        for _ in 0..60 {
            tick(&mut arm, &[source]);
        }
        let status = arm.controller.output().status;
        assert!(status.lost());
        // As long as may be bridged, it has to be good; then time goes on by the ramp.
        for _ in 0..21 {
            tick(&mut arm, &[]);
        }
        assert!(!arm.controller.output().status.lost(), "{source:?}");
        for _ in 0..100 {
            tick(&mut arm, &[]);
        }
        let output = arm.controller.output();
        assert_eq!((output.mode, output.rate), (Mode::Run, 1.0), "{source:?}");
        // Not all is forgotten: 121 good ticks have paid for 30 of the 60, more than may be bridged is still owed.
        assert!(tick(&mut arm, &[source]).status.lost(), "{source:?}");
        for _ in 0..200 {
            tick(&mut arm, &[]);
        }
        assert!(!tick(&mut arm, &[source]).status.lost(), "{source:?}");
    }
}

#[test]
fn bursts_with_long_pauses_become_a_fault_too() {
    // 100 ms bad, 300 ms good: a quarter of the time. Each period owes 25 ms more, until the ramp's 300 ms are too much.
    for source in [Source::Force, Source::StaleForce, Source::Position, Source::Rate] {
        let mut arm = moving(Mode::Run);
        let mut slow = settings();
        slow.timing.ramp = 0.3;
        arm.controller.set(slow).unwrap();
        let pattern = Pattern { bad: 100, of: 400 };
        let fault = (0..20 * 400).find(|&i| {
            let bad = if pattern.is_bad(i) { vec![source] } else { vec![] };
            tick(&mut arm, &bad).mode == Mode::Fault
        });
        assert!(fault.is_some(), "{source:?}");
    }
}

#[test]
fn velocity_is_zero_while_the_command_stands_still_and_motion_starts_from_rest() {
    let mut arm = moving(Mode::Run);
    let before = arm.controller.output();
    assert!(before.axes[0].velocity.abs() > 0.05);
    for dt in [f64::NAN, 0.0, -1.0, f64::INFINITY, 1e-7, f64::MIN_POSITIVE] {
        arm.dt = dt;
        let output = arm.step();
        assert!(output.status.bad_time && output.mode == Mode::Run);
        assert_eq!(output.axes.map(|axis| axis.velocity), [0.0; 2], "dt {dt}");
        assert_eq!(output.axes.map(|axis| axis.position), before.axes.map(|axis| axis.position));
    }
    arm.dt = DT;
    let mut last = arm.controller.output();
    for _ in 0..300 {
        let output = arm.step();
        for (now, last) in output.axes.iter().zip(&last.axes) {
            let velocity = (now.position - last.position) / DT;
            assert!((velocity - last.velocity).abs() <= 20.0 * DT + 1e-9, "{now:?} after {last:?}");
            assert_eq!(now.hits, Hits::default(), "the ramp keeps it on its path");
        }
        last = output;
    }
    assert_eq!(last.rate, 1.0);
}

#[test]
fn a_first_step_of_no_time_is_no_fault() {
    let mut arm = Arm::new(Family::Time, settings(), 2.0);
    arm.dt = 0.0;
    assert_eq!(arm.ask(Request::Start).mode, Mode::Run);
    arm.dt = DT;
    assert_eq!(arm.run(1.0).mode, Mode::Run);
}

#[test]
fn what_never_started_does_not_move() {
    let rest = |arm: &mut Arm| {
        let at = arm.controller.output().axes.map(|axis| axis.position);
        for _ in 0..3000 {
            assert_eq!(arm.step().axes.map(|axis| axis.position), at);
        }
    };
    // A trip, and a stop, in Idle.
    let mut arm = Arm::new(Family::Time, settings(), 2.0);
    arm.input.measured_force = [81.0, 0.0];
    arm.step();
    arm.input.measured_force = [70.0, 0.0];
    rest(&mut arm);
    assert_eq!(arm.controller.output().mode, Mode::Stop);
    let mut arm = Arm::new(Family::Time, settings(), 2.0);
    arm.input.measured_force = [70.0, 0.0];
    arm.ask(Request::Stop);
    rest(&mut arm);
    // A start in the very step of a trip.
    let mut arm = Arm::new(Family::Time, settings(), 2.0);
    arm.input.measured_force = [81.0, 0.0];
    assert_eq!(arm.ask(Request::Start).mode, Mode::Stop);
    rest(&mut arm);
    // Stop after a motion gives way, as ever.
    let mut arm = moving(Mode::Stop);
    arm.input.measured_force = [-6.0, 0.0];
    let output = arm.run(10.0);
    assert!((output.axes[0].offset + 6.0 / output.axes[0].stiffness).abs() < 1e-6);
}

#[test]
fn a_bad_reading_of_one_axis_blinds_no_other() {
    for y in [f64::NAN, f64::INFINITY] {
        let mut arm = moving(Mode::Run);
        arm.input.measured_force = [-81.0, y];
        let output = arm.step();
        assert!(output.status.force_tripped && output.status.bad_force && output.mode == Mode::Stop);

        let mut arm = moving(Mode::Run);
        let at = arm.controller.output().axes[0].position;
        arm.input.measured_position = Some([at + 0.051, y]);
        let output = arm.step();
        assert!(output.status.tracking_tripped && output.status.bad_input && output.mode == Mode::Stop);

        // What is read of the good axis is used.
        let mut arm = moving(Mode::Run);
        arm.input.measured_force = [7.0, y];
        let output = arm.step();
        assert_eq!((output.axes[0].force, output.axes[1].force), (7.0, 0.0));
    }
    // A stale reading says nothing of any axis, a dead clock does not hide a trip.
    let mut arm = moving(Mode::Run);
    (arm.input.measured_force, arm.input.force_age) = ([-81.0, 0.0], 9);
    assert!(!arm.step().status.force_tripped);
    let mut arm = moving(Mode::Run);
    (arm.input.measured_force, arm.dt) = ([-81.0, 0.0], f64::NAN);
    assert_eq!(arm.step().mode, Mode::Stop);
}

#[test]
fn a_stop_is_at_rest_within_the_longest_ramp() {
    for (ramp, accepted) in [(10.0, true), (10.01, false), (1e6, false), (1e300, false)] {
        let mut slow = settings();
        slow.timing.ramp = ramp;
        let mut arm = moving(Mode::Run);
        assert_eq!(arm.controller.set(slow).is_ok(), accepted, "ramp {ramp}");
        arm.ask(Request::Stop);
        let output = arm.run(10.0);
        assert_eq!((output.mode, output.rate), (Mode::Stop, 0.0));
    }
    // In single precision too, with the shortest steps.
    let mut slow = settings::<f32, 1>();
    slow.timing.ramp = 10.0;
    let mut arm = Rig::<f32, 1>::started(Family::Time, settings(), 2.0);
    arm.run(0.5);
    arm.controller.set(slow).unwrap();
    (arm.dt, arm.input.request) = (1e-6, Some(Request::Stop));
    arm.step();
    arm.input.request = None;
    let before = arm.controller.output().rate;
    for _ in 0..1000 {
        arm.step();
    }
    assert!(arm.controller.output().rate < before - 5e-5, "it does not stall");
}

#[test]
fn the_table_in_the_docs_is_that_of_the_code() {
    let rows = |text: &str| -> Vec<String> {
        let lines = text.lines().map(|line| line.trim_start_matches("//! "));
        let table =
            lines.skip_while(|line| !line.starts_with("| input | bad where")).take_while(|l| l.starts_with('|'));
        table.map(|line| line.replace("[`CLOCK_STEPS`]", "20")).collect()
    };
    let code = rows(include_str!("../src/controller/faults.rs"));
    assert_eq!(hpf_core::controller::faults::CLOCK_STEPS, 20.0);
    assert!(code.len() > 4);
    assert_eq!(code, rows(include_str!("../../../docs/embedding.md")));
}

#[test]
fn an_input_that_is_good_again_is_no_fault_for_shorter_limits_either() {
    for source in [Source::Force, Source::StaleForce, Source::Position] {
        for mode in [Mode::Run, Mode::Hold] {
            let mut patient = settings::<f64, 2>();
            (patient.timing.hold, patient.timing.ramp) = (0.5, 1.0);
            let mut arm = Arm::started(Family::Time, patient, 20.0);
            arm.run(0.5);
            if mode == Mode::Hold {
                arm.ask(Request::Hold);
            }
            // Bad for less than its limit; then good for far longer than the limits that come.
            for _ in 0..400 {
                tick(&mut arm, &[source]);
            }
            for _ in 0..300 {
                tick(&mut arm, &[]);
            }
            let mut strict = patient;
            (strict.timing.hold, strict.timing.ramp) = (0.02, 0.01);
            arm.controller.set(strict).unwrap();
            for _ in 0..2000 {
                let output = tick(&mut arm, &[]);
                assert_eq!((output.mode, output.status.lost()), (mode, false), "{source:?}");
            }
        }
    }
}
