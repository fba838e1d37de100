fn settings<T: Real + PartialOrd>() -> Settings<T, 1> {
    crate::support::settings()
}

/// A controller brought into `mode` and to rest.
fn in_mode(mode: Mode) -> Arm {
    let mut rig = Arm::new(KIND, settings(), 2.0);
    if mode != Mode::Idle {
        rig.ask(Request::Start);
        rig.run(0.5);
    }
    match mode {
        Mode::Idle | Mode::Run => {}
        Mode::Hold => drop(rig.ask(Request::Hold)),
        Mode::Stop => drop(rig.ask(Request::Stop)),
        Mode::Fault => {
            rig.input.measured_force = [f64::NAN];
            rig.run(0.5);
            rig.input.measured_force = [0.0];
        }
    }
    rig.run(0.2);
    assert_eq!(rig.controller.output().mode, mode);
    rig
}

#[test]
fn the_controller_goes_through_that_table_and_no_other() {
    for mode in MODES {
        for event in EVENTS {
            let mut rig = in_mode(mode);
            let before = *rig.controller.counters();
            let request = match event {
                Event::Start => Some(Request::Start),
                Event::Hold => Some(Request::Hold),
                Event::Resume => Some(Request::Resume),
                Event::Stop => Some(Request::Stop),
                Event::Reset => Some(Request::Reset([0.1])),
                Event::Tripped | Event::Lost => None,
            };
            let output = match request {
                Some(request) => rig.ask(request),
                None if event == Event::Tripped => {
                    rig.input.measured_force = [100.0];
                    rig.step()
                }
                None => {
                    rig.input.force_age = 5;
                    rig.run(0.5)
                }
            };
            let expected = mode.after(event);
            assert_eq!(output.mode, expected.unwrap_or(mode), "{mode:?} on {event:?}");
            assert_eq!(output.status.refused, expected.is_none());
            assert_eq!(rig.controller.counters().refused - before.refused, u32::from(expected.is_none()));
        }
    }
}

#[test]
fn the_start_is_bumpless_wherever_the_robot_is() {
    for position in [-0.2, 0.0, 0.37] {
        let mut controller = Controller::new(skill::<f64, 1>(KIND, 2.0), settings(), [position]).unwrap();
        let mut input = crate::support::input([0.0]);
        let idle = controller.update(&input, DT);
        assert_eq!((idle.axes[0].position, idle.axes[0].velocity, idle.axes[0].offset), (position, 0.0, 0.0));
        input.request = Some(Request::Start);
        let first = controller.update(&input, DT);
        // From rest, within the limit of acceleration: 20 um.
        assert!((first.axes[0].position - position).abs() <= 20.0 * DT * DT * (1.0 + 1e-9), "{first:?}");
    }
}

#[test]
fn a_start_takes_no_ramp_and_keeps_the_limit_of_acceleration() {
    let mut hard = settings();
    hard.axes[0].limits.acceleration = 2.0; // the pull to the goal begins with 12 m/s^2
    for settings in [settings(), hard] {
        let most = settings.axes[0].limits.acceleration * DT * (1.0 + 1e-9);
        let mut rig = Arm::new(KIND, settings, 2.0);
        rig.run(0.1);
        let (mut last, mut output) = (0.0, rig.ask(Request::Start));
        for step in 1..=2000 {
            let exact = (-4.605_17 * f64::from(step) * DT / 2.0).exp();
            assert_eq!(output.rate, 1.0, "at step {step}");
            assert!((output.phase - exact).abs() < 1e-12, "{} at step {step}, not {exact}", output.phase);
            assert!((output.axes[0].velocity - last).abs() <= most, "at step {step}");
            last = output.axes[0].velocity;
            output = rig.step();
        }
    }
}

#[test]
fn a_start_goes_at_the_rate_asked_for_and_under_way_the_ramp_rules() {
    let mut rig = Arm::new(KIND, settings(), 2.0);
    rig.input.rate = 0.4;
    assert_eq!(rig.ask(Request::Start).rate, 0.4);
    // A tenth of a second from 0 to 1: a hundredth each step.
    for (asked, next) in [(1.0, 0.41), (1.0, 0.42), (0.0, 0.41), (0.0, 0.40)] {
        rig.input.rate = asked;
        let found = rig.step().rate;
        assert!((found - next).abs() < 1e-12, "{found}, not {next}");
    }
    // A pause before the movement has begun is no pause of a motion.
    let mut rig = Arm::new(KIND, settings(), 2.0);
    rig.input.rate = 0.0;
    rig.ask(Request::Start);
    rig.ask(Request::Hold);
    rig.input.rate = 1.0;
    assert_eq!((rig.step().rate, rig.ask(Request::Resume).rate), (0.0, 1.0));
}

#[test]
fn without_a_ramp_the_path_stops_at_once_and_the_tool_within_its_limits() {
    for ramp in [0.0, -0.0] {
        let mut at_once = settings();
        at_once.timing.ramp = ramp;
        let mut rig = Arm::started(KIND, at_once, 2.0);
        let moving = rig.run(0.7).axes[0];
        assert!(moving.velocity.abs() > 0.05, "{moving:?}");
        let held = rig.ask(Request::Hold);
        assert_eq!(held.rate, 0.0);
        let (mut last, mut output, mut farthest) = (moving, held, 0.0_f64);
        for _ in 0..4000 {
            let axis = output.axes[0];
            assert!((axis.velocity - last.velocity).abs() <= 20.0 * DT * (1.0 + 1e-9), "{axis:?} after {last:?}");
            assert!((axis.position - last.position - axis.velocity * DT).abs() < 1e-12, "{axis:?} after {last:?}");
            farthest = farthest.max(axis.offset.abs());
            (last, output) = (axis, rig.step());
        }
        // Its way to a stop is an offset, which the law takes back: v^2/(2 a).
        let stop = moving.velocity.powi(2) / (2.0 * 20.0);
        assert!(farthest < 1.2 * stop + 1e-3, "{farthest} m, {stop} m to a stop");
        assert!(last.offset.abs() < 1e-5 && last.velocity.abs() < 1e-5, "{last:?}");
        assert_eq!(rig.ask(Request::Resume).rate, 1.0);
    }
}

/// Phase and position over `seconds`, whatever `each` asks for at a step.
fn path(rig: &mut Arm, seconds: f64, mut each: impl FnMut(usize) -> Option<Request<f64, 1>>) -> Vec<[f64; 2]> {
    (0..(seconds / DT) as usize)
        .map(|i| {
            rig.input.request = each(i);
            let output = rig.step();
            [output.phase, output.axes[0].position]
        })
        .collect()
}

/// The largest distance of `other` from the path of `nominal` at equal phase.
fn off_path(nominal: &[[f64; 2]], other: &[[f64; 2]]) -> f64 {
    other
        .iter()
        .filter(|[s, _]| *s < 1.0)
        .map(|[s, x]| {
            let after = nominal.iter().position(|[phase, _]| phase <= s).unwrap_or(nominal.len() - 1).max(1);
            let ([s0, x0], [s1, x1]) = (nominal[after - 1], nominal[after]);
            (x - (x0 + (x1 - x0) * (s - s0) / (s1 - s0))).abs()
        })
        .fold(0.0, f64::max)
}

#[test]
fn pausing_slowing_and_resuming_stay_on_the_path() {
    let nominal = path(&mut Arm::started(KIND, settings(), 2.0), 4.0, |_| None);
    let mut rig = Arm::started(KIND, settings(), 2.0);
    let paused = path(&mut rig, 4.0, |i| match i {
        600 => Some(Request::Hold),
        1600 => Some(Request::Resume),
        _ => None,
    });
    assert!((paused[1000][0] - paused[1599][0]).abs() < 1e-15, "the path is at rest in Hold");
    let gap = off_path(&nominal, &paused);
    assert!(gap < 1e-5, "{gap:e}"); // second order in rate times dt, and the chords of the comparison
    let mut slow = Arm::started(KIND, settings(), 2.0);
    slow.input.rate = 0.3;
    let gap = off_path(&nominal, &path(&mut slow, 6.0, |_| None));
    assert!(gap < 1e-5, "{gap:e}");
}

#[test]
fn a_path_too_fast_for_the_velocity_limit_is_walked_slower_not_cut() {
    let nominal = path(&mut Arm::started(KIND, settings(), 2.0), 20.0, |_| None);
    let mut slow = settings();
    slow.axes[0].limits.velocity = 0.05;
    let mut rig = Arm::started(KIND, slow, 2.0);
    let walked = path(&mut rig, 20.0, |_| None);
    let gap = off_path(&nominal, &walked);
    // Where time starts to slow, the acceleration limit cuts once; 20 um of the 300 mm.
    assert!(gap < 1e-4, "{gap:e}");
    assert!((walked[19_999][1] - 0.3).abs() < 2e-3);
}

#[test]
fn a_new_goal_in_flight_is_no_jump() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    let mut last = rig.run(1.0).axes[0];
    let mut jolt = 0.0_f64;
    let mut output = rig.ask(Request::Goal([-0.2]));
    for _ in 0..6000 {
        jolt = jolt.max((output.axes[0].velocity - last.velocity).abs() / DT);
        last = output.axes[0];
        assert_eq!(last.hits, hpf_core::limits::Hits::default());
        output = rig.step();
    }
    assert!(jolt < 6.0, "{jolt} m/s^2"); // 0.5 m in 2 s with alpha = 25: p^2 0.5/4 = 20 if it jumped
    assert!((last.position + 0.2).abs() < 1e-4, "{last:?}");
}

#[test]
fn the_end_is_flagged_once_and_held_compliantly() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    let ended: Vec<usize> = (0..4000).filter(|_| rig.step().status.ended).collect();
    // Two seconds, less the step of the start and the one that is number 0.
    assert_eq!(ended.len(), 1);
    assert!((1997..=1999).contains(&ended[0]), "{ended:?}");
    rig.input.measured_force = [18.0];
    let output = rig.run(5.0);
    assert_eq!(output.mode, Mode::Run);
    assert!((output.axes[0].offset - 18.0 / output.axes[0].stiffness).abs() < 1e-6, "{output:?}");
    rig.input.measured_force = [0.0];
    let output = rig.run(5.0);
    assert!((output.axes[0].position - 0.3).abs() < 1e-6 && output.axes[0].velocity.abs() < 1e-6, "{output:?}");
}

#[test]
fn every_compliance_does_what_it_says() {
    let at_goal = |compliance: Compliance<f64>, law: Law<f64>| {
        let mut settings = settings();
        settings.axes[0].compliance = compliance;
        let mut rig = Arm::started(Kind { law, ..KIND }, settings, 1.0);
        rig.run(4.0);
        rig
    };
    let second = |damping| Law::SecondOrder { mass: 2.0, damping };
    for law in [Law::FirstOrder, second(Damping::Primitive), second(Damping::Ratio { ratio: 0.7, floor: 5.0 })] {
        let mut rigid = at_goal(Compliance::Rigid, law);
        rigid.input.measured_force = [30.0];
        assert!((rigid.run(1.0).axes[0].position - 0.3).abs() < 1e-6);

        let mut compliant = at_goal(Compliance::Compliant, law);
        compliant.input.measured_force = [30.0];
        let axis = compliant.run(4.0).axes[0];
        assert!((axis.offset - 30.0 / axis.stiffness).abs() < 1e-6, "{axis:?}");

        // A wall of 2 kN/m at the goal answers; k e of the 10 N remain in the spring.
        let mut pressing = at_goal(Compliance::Press(10.0), law);
        let mut axis = pressing.step().axes[0];
        for _ in 0..8000 {
            pressing.input.measured_force = [-2000.0 * (axis.position - 0.3).max(0.0)];
            axis = pressing.step().axes[0];
        }
        let pressure = 2000.0 * (axis.position - 0.3);
        assert!((pressure - 10.0 * 2000.0 / (2000.0 + axis.stiffness)).abs() < 1e-3, "{pressure} N");
    }
    let damped = |ratio| Kind { law: second(Damping::Ratio { ratio, floor: 5.0 }), ..KIND };
    let axis = Arm::started(damped(0.7), settings(), 1.0).run(4.0).axes[0];
    assert!((axis.damping - 2.0 * 0.7 * (2.0 * axis.stiffness).sqrt()).abs() < 1e-9, "{axis:?}");
    assert_eq!(Arm::started(damped(0.01), settings(), 1.0).run(4.0).axes[0].damping, 5.0);
}

#[test]
fn the_offset_limit_stops_softly_and_nothing_winds_up() {
    let mut rig = Arm::started(KIND, settings(), 1.0);
    rig.run(3.0);
    rig.input.measured_force = [-75.0]; // 50 N of them enter, and want 0.14 m
    let mut soft = settings();
    soft.axes[0].limits.offset = 0.05;
    rig.controller.set(soft).unwrap();
    let pressed = rig.run(20.0);
    let axis = pressed.axes[0];
    assert!((axis.offset + 0.05).abs() < 1e-6 && axis.hits.offset && axis.hits.force, "{axis:?}");
    assert!((axis.position - 0.25).abs() < 1e-4, "the reference stays at its goal: {axis:?}");
    // Released, it leaves at once: by the law, as if it had never been pressed longer.
    rig.input.measured_force = [0.0];
    let (k, d) = (axis.stiffness, axis.damping);
    let released = rig.run(0.2).axes[0];
    let free = step_offset(-0.05, k, d, 0.0, 0.2);
    assert!((released.offset - free).abs() < 2e-3, "{} {free}", released.offset); // the acceleration limit's share
}

#[test]
fn at_the_wall_only_outward_motion_is_cut() {
    let mut tight = settings();
    tight.axes[0].limits.position = [-0.4, 0.32];
    let mut rig = Arm::started(KIND, tight, 1.0);
    rig.run(3.0);
    rig.input.measured_force = [30.0];
    let axis = rig.run(10.0).axes[0];
    assert!(axis.position <= 0.32 && axis.position > 0.3199 && axis.hits.position, "{axis:?}");
    rig.input.measured_force = [-30.0];
    let inward = rig.run(0.05).axes[0];
    assert!(inward.position < 0.31 && !inward.hits.position, "{inward:?}");
}

#[test]
fn single_precision_reaches_its_goal() {
    // A state that held the position itself would stop 2 um to 200 um short: its last steps round to zero.
    for (duration, rate) in [(1.0, 1000.0), (10.0, 8000.0)] {
        let mut rig = Rig::<f32, 1>::started(KIND, settings(), duration);
        rig.dt = 1.0 / rate;
        let axis = rig.run(4.0 * duration).axes[0];
        assert!((axis.position - 0.3).abs() <= f32::EPSILON, "{axis:?}");
        assert!(axis.velocity.abs() < 1e-6, "{axis:?}");
    }
}

/// Position 1.2 s into the movement under a constant push, at `rate` Hz.
fn at_rate(rate: f64) -> f64 {
    let mut free = settings();
    // A limit is met by whole steps.
    (free.axes[0].limits.velocity, free.axes[0].limits.acceleration) = (10.0, 1e4);
    let mut rig = Arm::new(KIND, free, 2.0);
    rig.dt = 1.0 / rate;
    rig.input.measured_force = [6.0];
    rig.ask(Request::Start);
    rig.run(1.2 - rig.dt).axes[0].position
}

#[test]
fn the_motion_is_the_same_at_every_loop_rate() {
    let positions = [100.0, 1000.0, 8000.0].map(at_rate);
    // Second order in the step: the force is held, and the start is where the motion is.
    assert!((positions[0] - positions[2]).abs() < 1e-5, "{positions:?}");
    assert!((positions[1] - positions[2]).abs() < 1e-7, "{positions:?}");
}

#[test]
fn the_tank_slows_the_path_that_works_against_the_environment() {
    // The environment pulls back with 15 N all the way; 0.3 m of that would cost 4.5 J, the tank has 1 J.
    let mut with_tank = settings();
    with_tank.axes[0].limits.offset = 0.5;
    with_tank.axes[0].limits.position = [-1.0, 1.0];
    with_tank.axes[0].limits.acceleration = 1e4;
    with_tank.tank = Some(EnergyTank::new(1.0, 0.0, 0.5, 1e3).unwrap());
    let run = |settings| {
        let mut rig = Arm::started(KIND, settings, 2.0);
        rig.input.measured_force = [-15.0];
        let (mut work, mut least, mut short, mut last) = (0.0_f64, 0.0_f64, 0, 0.0);
        for _ in 0..10_000 {
            let output: Output<f64, 1> = rig.step();
            work += -15.0 * (output.axes[0].position - last);
            last = output.axes[0].position;
            least = least.min(work);
            short += u32::from(output.status.energy_short);
            assert!(output.energy >= -1e-12 || rig.controller.settings().tank.is_none());
        }
        (least, short, rig.controller.output().phase)
    };
    let (least, short, phase) = run(with_tank);
    assert!(least >= -1.0 && short > 0, "{least} J, short {short} times");
    let mut without = with_tank;
    without.tank = None;
    let (_, never, free_phase) = run(without);
    assert!(never == 0 && free_phase < phase, "{free_phase} {phase}");
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let mut rig = in_mode(Mode::Run);
    for request in [Request::Goal([f64::NAN]), Request::Goal([0.6]), Request::Tare, Request::Reset([0.0])] {
        let before = rig.controller.output();
        let after = rig.ask(request);
        assert!(after.status.refused && after.mode == before.mode);
    }
    let mut rig = in_mode(Mode::Stop);
    for request in [Request::Goal([0.1]), Request::Reset([f64::NAN]), Request::Reset([0.9])] {
        assert!(rig.ask(request).status.refused);
    }
    let mut rig = in_mode(Mode::Idle);
    rig.input.measured_force = [3.0];
    rig.step();
    assert!(rig.ask(Request::Tare).status.refused, "it has not stood still for long enough");
    rig.run(0.5);
    assert!(!rig.ask(Request::Tare).status.refused);
    rig.ask(Request::Start);
    assert!(rig.run(1.0).axes[0].offset.abs() < 1e-15, "3 N of bias are gone");
}
