use std::fs;

use hpf_sim::cost::Term;
use hpf_sim::{Policy, Simulation, Task};

use super::*;
use crate::results::LearningRow;

const GAINS: &str = "[stiffness]\ninitial = 100.0\nmin = 30.0\nmax = 400.0\n\
    [damping]\ninitial = 50.0\nmin = 10.0\nmax = 100.0\n[cost]\ngoal = 1e4\nstiffness = 1e-5\n";
const BEAM: &str = "[contact]\nkind = \"cantilever\"\naxis = \"y\"\nlength = 0.8\nwidth = 0.05\nthickness = 0.004\n\
    youngs_modulus = 200e9\nforce = 10.0\n";
const WALL: &str = "[contact]\nkind = \"wall\"\naxis = \"y\"\nposition = 0.02\nstiffness = 1e4\nforce = 5.0\n";

const PUSH: &str =
    "[[disturbance]]\nkind = \"sine\"\naxis = \"x\"\namplitude = { uniform = [-9.0, 9.0] }\nperiod = 1.0\n";

fn axis(name: &str, unit: &str) -> String {
    format!("[[axis]]\nname = \"{name}\"\nunit = \"{unit}\"\nstart = 0.0\ngoal = 0.032\n")
}

/// A run of the policy before learning, as it was before and after one update.
fn run(name: &str, axes: &[String], rest: &str) -> Run {
    let text = format!("name = \"{name}\"\nduration = 1.0\nrate = 100.0\n{}{rest}{GAINS}", axes.concat());
    let task = Task::parse(&text).unwrap();
    let policy = Policy::initial(&task).unwrap();
    let simulation = Simulation::new(&task, &policy).unwrap();
    let trajectory = simulation.rollout(&simulation.parameters(&policy));
    let cost = simulation.cost(&trajectory);
    let row = |update| LearningRow {
        update,
        rollouts: 1 + 20 * update,
        total: cost.total(),
        terms: cost.terms.clone(),
        exploration: 1.0,
    };
    let snapshots = vec![(0, trajectory.clone())];
    Run { learning: vec![row(0), row(1)], task, policy, trajectory, snapshots, demonstrations: Vec::new() }
}

fn runs() -> Vec<Run> {
    let [x, y, turn] = [axis("x", "m"), axis("y", "m"), axis("turn", "rad")];
    let long = "a_very_long_name_of_an_axis_____";
    let seven: Vec<String> =
        (1..=7).map(|i| if i == 4 { axis(long, "rad") } else { axis(&format!("q{i}"), "m") }).collect();
    let mut imitated = run("imitated", &[x.clone(), turn.clone()], "");
    imitated.demonstrations = vec![imitated.trajectory.axes.iter().map(|axis| axis.position.clone()).collect(); 2];
    vec![
        run("reach", core::slice::from_ref(&x), ""),
        run(
            "plane",
            &[x.clone(), y.clone()],
            &format!("{PUSH}[[via_point]]\nradius = 0.001\nposition = [0.01, 0.02]\n"),
        ),
        run("mixed", &[x.clone(), turn], ""),
        run("seven", &seven, ""),
        run("beam", core::slice::from_ref(&y), BEAM),
        run("beam_and_more", &[x.clone(), y.clone()], BEAM),
        run("wall", &[y], WALL),
        imitated,
    ]
}

#[test]
fn the_kind_of_task_decides_which_figures_there_are() {
    let names = |run: &Run| figures(run).into_iter().map(|drawing| drawing.name).collect::<Vec<_>>().join(" ");
    let found: Vec<String> = runs().iter().map(names).collect();
    let free = "cost stiffness damping path";
    assert_eq!([&found[0], &found[2], &found[3]], [free; 3]);
    assert_eq!(found[1], "cost stiffness damping disturbance path");
    assert_eq!(found[4], "cost stiffness damping beam path deviation contact_force");
    assert_eq!(found[5], "cost stiffness damping beam path position deviation contact_force");
    assert_eq!(found[6], "cost stiffness damping path deviation contact_force");
    assert_eq!(found[7], format!("{free} demonstration"));
}

#[test]
fn the_disturbance_that_stands_out_is_that_of_the_motion_shown() {
    let run = &runs()[1];
    let figure = signals::disturbance(run);
    let [.., shown] = &figure.panels[0].layers[..] else { panic!("no line") };
    assert_eq!(figure.panels[0].layers.len(), 1 + 20, "the rest time, and a few of the 100 draws");
    let after: Vec<f64> = shown.points().iter().skip(1).step_by(2).map(|point| point.1).collect();
    assert_eq!(after, run.trajectory.axes[0].force);
    assert!(after.iter().any(|force| *force != 0.0));
}

#[test]
fn a_run_that_is_called_like_something_else_is_in_the_legend_too() {
    let run = &runs()[6];
    for name in ["wall", "goal", "rest time, after the end"] {
        let named = [name, "other"].map(|name| Named { name: name.into(), run });
        for drawing in overlaid(&named).iter().filter(|drawing| drawing.name != "cost") {
            let figure = (drawing.make)();
            let lines = figure.legend().into_iter().filter(|layer| ends::is_line(layer));
            let called: Vec<_> = lines.filter_map(|layer| layer.label.clone()).collect();
            assert!(called.iter().any(|label| label == name), "{}: {called:?}", drawing.name);
        }
    }
}

#[test]
fn the_font_has_every_sign_that_figures_use() {
    for run in runs() {
        let named = [&run, &run].map(|run| Named { name: run.task.name.clone(), run });
        for drawing in figures(&run).into_iter().chain(overlaid(&named)) {
            let (name, figure) = (&drawing.name, (drawing.make)());
            let mut texts = vec![figure.title.clone()];
            texts.extend(figure.legend().iter().filter_map(|layer| layer.label.clone()));
            for panel in &figure.panels {
                texts.extend([panel.heading.clone(), panel.note.clone(), panel.x.title(), panel.y.title()]);
                texts.extend(panel.y.ticks(5.0).into_iter().map(|tick| tick.label));
            }
            for text in texts {
                assert!(text::has_glyphs(&text), "{name} of {}: {text}", run.task.name);
            }
        }
    }
    assert!(text::has_glyphs("10⁻⁰¹²³⁴⁵⁶⁷⁸⁹ − … · ±"));
}

#[test]
fn every_figure_is_written_whole_and_with_the_same_bytes_each_time() {
    let folder = std::env::temp_dir().join(format!("hpf-figure-{}", std::process::id()));
    let image = |name: &String| fs::read(folder.join(name)).unwrap();
    for run in runs() {
        for (format, magic) in [(Format::Png, &b"\x89PNG"[..]), (Format::Svg, b"<svg ")] {
            let draw = || draw(&figures(&run), "a < b & c", format, &folder).unwrap();
            let names = draw();
            let first: Vec<_> = names.iter().map(image).collect();
            assert_eq!(draw(), names);
            for (name, bytes) in names.iter().zip(&first) {
                assert!(bytes.starts_with(magic) && image(name) == *bytes, "{name} of {}", run.task.name);
            }
        }
    }
    assert!(fs::read_dir(&folder).unwrap().all(|entry| !entry.unwrap().path().to_string_lossy().contains("partial")));
    fs::remove_dir_all(&folder).unwrap();
}

/// The number that a label says.
fn said(label: &str) -> f64 {
    let plain = |text: &str| text.replace('−', "-");
    let raised =
        |sign: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().position(|digit| digit == sign).map_or('-', |d| char::from(b'0' + d as u8));
    let (mantissa, power) = match label.split_once("·10").or_else(|| Some(("1", label.strip_prefix("10")?))) {
        Some((mantissa, power))
            if !power.is_empty() && !power.starts_with(|c: char| c.is_ascii_digit() || c == '.') =>
        {
            (mantissa, power.chars().map(raised).collect())
        }
        _ => (label, "0".to_owned()),
    };
    format!("{}e{power}", plain(mantissa)).parse().unwrap_or_else(|_| panic!("{label} is no number"))
}

/// What stands along the axis of cost, for these totals: every label says its number, and all differ.
fn expect_readable(totals: &[f64]) {
    let mut run = run("any", &[axis("x", "m")], "");
    run.learning = totals
        .iter()
        .enumerate()
        .map(|(update, total)| LearningRow {
            update,
            total: *total,
            terms: vec![0.0; Term::ALL.len()],
            ..run.learning[0].clone()
        })
        .collect();
    let named = [Named { name: "a".into(), run: &run }, Named { name: "b".into(), run: &run }];
    let mut all = overlaid(&named);
    all.retain(|drawing| drawing.name == "cost");
    all.extend(figures(&run).into_iter().filter(|drawing| drawing.name == "cost"));
    for drawing in all {
        let figure = (drawing.make)();
        let y = &figure.panels[0].y;
        assert!(y.low < y.high && totals.iter().all(|t| (y.low..=y.high).contains(t)), "{totals:?}: {y:?}");
        let factor = y.title().split_once('[').map_or(1.0, |(_, unit)| said(unit.trim_end_matches(']')));
        let labelled: Vec<_> = y.ticks(8.0).into_iter().filter(|tick| !tick.label.is_empty()).collect();
        assert!((2..=12).contains(&labelled.len()), "{totals:?}: {labelled:?}");
        for tick in &labelled {
            let error = (said(&tick.label) * factor - tick.value).abs();
            assert!(error <= 1e-9 * tick.value.abs().max(y.high - y.low), "{totals:?}: {tick:?}");
            assert!(tick.label.chars().count() <= 14, "{tick:?}");
        }
        assert!(labelled.windows(2).all(|pair| pair[0].label != pair[1].label), "{labelled:?}");
        for format in [Format::Png, Format::Svg] {
            canvas::draw((drawing.make)(), "subject", format).unwrap();
        }
    }
}

#[test]
fn costs_of_every_size_and_sign_have_axes_that_say_their_numbers() {
    for exponent in (-300..=300).step_by(25).chain([-14, -5, -3, 0, 4, 5, 6, 88]) {
        let size = 10.0_f64.powi(exponent);
        for shape in
            [&[1.0][..], &[1.0, 1.3], &[7.0, 1.0], &[1.0, 0.02], &[-1.0, -0.994], &[1.0, -1.0], &[1.0, 0.0], &[0.0]]
        {
            // The largest stays within what axes hold.
            expect_readable(&shape.iter().map(|share| 0.1 * size * share).collect::<Vec<_>>());
        }
    }
    assert_eq!(said("1.5·10⁻¹⁴"), 1.5e-14);
    assert_eq!([said("10⁷"), said("−2·10³"), said("100"), said("10")], [1e7, -2e3, 100.0, 10.0]);
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(48))]

    #[test]
    fn any_costs_are_drawn(totals in proptest::collection::vec(proptest::num::f64::ANY, 1..6)) {
        let mut run = run("any", &[axis("x", "m")], "");
        run.learning = totals.iter().enumerate().map(|(update, total)| LearningRow { update, total: *total, terms: vec![*total; Term::ALL.len()], ..run.learning[0].clone() }).collect();
        for drawing in figures(&run).into_iter().filter(|drawing| drawing.name == "cost") {
            for format in [Format::Png, Format::Svg] {
                canvas::draw((drawing.make)(), "subject", format).unwrap();
            }
        }
    }
}
