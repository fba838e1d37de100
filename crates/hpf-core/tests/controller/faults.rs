#[test]
fn a_bad_force_is_bridged_then_frozen_then_a_fault() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut rig = Arm::started(KIND, settings(), 2.0);
        rig.input.measured_force = [10.0];
        let good = rig.run(1.0);
        rig.input.measured_force = [bad];
        let bridged = rig.run(0.019); // of the 20 ms that may be bridged
        assert!(bridged.status.bad_force && !bridged.status.force_lost);
        assert_eq!(bridged.axes[0].force, good.axes[0].force, "the last good force stands in");
        let frozen = rig.run(0.002);
        assert!(frozen.status.force_lost && frozen.mode == Mode::Run && frozen.rate < 1.0);
        let fault = rig.run(0.2); // the ramp takes 0.1 s
        assert_eq!((fault.mode, fault.rate), (Mode::Fault, 0.0));
        let still = rig.run(1.0);
        assert_eq!(still.axes[0].position, fault.axes[0].position);
        assert_eq!(rig.controller.counters().faults, 1);
        // A fault is latched, whatever the sensor does, until a reset.
        rig.input.measured_force = [0.0];
        assert_eq!(rig.run(1.0).mode, Mode::Fault);
        assert_eq!(rig.ask(Request::Reset([0.2])).mode, Mode::Idle);
        rig.ask(Request::Start);
        assert!((rig.run(4.0).axes[0].position - 0.3).abs() < 1e-3);
    }
}

#[test]
fn a_force_that_comes_back_in_time_is_no_fault() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    rig.run(0.5);
    rig.input.force_age = 5; // older than allowed
    let lost = rig.run(0.06);
    assert!(lost.status.force_lost && lost.rate > 0.0 && lost.rate < 1.0, "{lost:?}");
    rig.input.force_age = 4;
    let back = rig.run(0.2);
    assert_eq!((back.mode, back.rate), (Mode::Run, 1.0));
    assert_eq!(rig.controller.counters().bad_force, 60);
}

#[test]
fn too_much_force_or_too_little_obedience_stops() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    rig.run(0.5);
    rig.input.measured_force = [-81.0];
    let tripped = rig.step();
    assert!(tripped.mode == Mode::Stop && tripped.status.force_tripped && tripped.axes[0].hits.force);
    rig.input.measured_force = [-6.0];
    let stopped = rig.run(10.0);
    assert_eq!((stopped.mode, stopped.rate), (Mode::Stop, 0.0));
    assert!((stopped.axes[0].offset + 6.0 / stopped.axes[0].stiffness).abs() < 1e-6, "still compliant");

    let mut rig = Arm::started(KIND, settings(), 2.0);
    let output = rig.run(0.5);
    rig.input.measured_position = Some([output.axes[0].position - 0.049]);
    assert_eq!(rig.step().mode, Mode::Run);
    rig.input.measured_position = Some([f64::NAN]);
    assert!(rig.step().status.bad_input);
    rig.input.measured_position = Some([output.axes[0].position - 0.051]);
    let output = rig.step();
    assert!(output.mode == Mode::Stop && output.status.tracking_tripped);
}

#[test]
fn a_bad_time_stands_still_and_a_long_one_is_cut() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    let before = rig.run(0.5);
    for dt in [0.0, -1e-3, f64::NAN, f64::INFINITY] {
        rig.dt = dt;
        let output = rig.step();
        assert!(output.status.bad_time);
        let still = before.axes.map(|axis| AxisOutput { velocity: 0.0, ..axis });
        assert_eq!((output.axes, output.phase, output.rate), (still, before.phase, 0.0));
    }
    assert_eq!(rig.controller.counters().bad_time, 4);
    let mut rig = Arm::started(KIND, settings(), 2.0);
    rig.run(0.5);
    let mut other = Arm::started(KIND, settings(), 2.0);
    other.run(0.5);
    (rig.dt, other.dt) = (5.0, 0.01);
    let (cut, exact) = (rig.step(), other.step());
    assert!(cut.status.long_time && !exact.status.long_time);
    assert_eq!(cut.axes, exact.axes);
    // A stop is heard even then.
    rig.dt = f64::NAN;
    assert_eq!(rig.ask(Request::Stop).mode, Mode::Stop);
}

#[test]
fn bad_settings_are_refused_whole() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    rig.input.measured_force = [10.0];
    let moving = rig.run(0.6);
    let good = *rig.controller.settings();
    let with = |change: &dyn Fn(&mut Settings<f64, 1>)| {
        let mut settings = good;
        settings.timing.ramp = 0.5; // a good change beside the bad one must not come through
        change(&mut settings);
        settings
    };
    let refused = [
        (with(&|s| s.timing.hold = f64::NAN), "timing.hold is not a finite number"),
        (with(&|s| s.timing.longest_step = 0.0), "timing.longest_step must be positive, not 0"),
        (with(&|s| s.axes[0].limits.acceleration = -1.0), "limits.acceleration must be positive, not -1"),
        (with(&|s| s.axes[0].compliance = Compliance::Press(60.0)), "press must lie in [-50, 50], not 60"),
        (with(&|s| s.axes[0].limits.position = [0.31, 0.5]), "goal must lie in [0.31, 0.5], not 0.3"),
        (with(&|s| s.conditioning.dead_zone = [-1.0]), "conditioning.dead_zone must lie in [0, 1000000000], not -1"),
    ];
    let count = refused.len() as u32;
    for (settings, text) in refused {
        assert_eq!(rig.controller.set(settings).unwrap_err().to_string(), text);
        assert_eq!(*rig.controller.settings(), good);
    }
    // What the present motion would break is refused too.
    for change in [
        with(&|s| s.axes[0].limits.velocity = moving.axes[0].velocity.abs() / 2.0),
        with(&|s| s.axes[0].limits.offset = moving.axes[0].offset / 2.0),
    ] {
        assert!(rig.controller.set(change).is_err());
    }
    assert_eq!(rig.controller.counters().refused, count + 2);
    rig.controller.set(with(&|s| s.timing.hold = 0.1)).unwrap();
}

#[test]
fn a_change_of_limits_is_no_jump() {
    let mut rig = Arm::started(KIND, settings(), 2.0);
    rig.input.measured_force = [8.0];
    let mut last = rig.run(1.0).axes[0];
    let mut changed = settings();
    changed.axes[0].limits.offset = 0.1;
    changed.timing.longest_step = 0.05;
    for settings in [changed, settings()] {
        rig.controller.set(settings).unwrap();
        for _ in 0..500 {
            let next = rig.step().axes[0];
            assert!((next.position - (last.position + next.velocity * DT)).abs() < 1e-12);
            assert!((next.velocity - last.velocity).abs() <= 20.0 * DT + 1e-12);
            last = next;
        }
    }
}
