//! `hpf plot`

use std::fs;

use crate::support::{expect, folder, read, task};

#[test]
fn plots_are_drawn_again_from_the_tables_and_are_the_same() {
    let folder = folder();
    let few = ["--set", "learning.updates=20", "--set", "output.snapshots=[0,20]", "--set", "accept={}"];
    for name in ["via_point", "cantilever", "reach"] {
        let file = task(&format!("{name}.toml"));
        expect(0, folder.path(), &[&["learn", &file, "--quiet", "--out", name][..], &few].concat());
        let (_, stderr) = expect(2, folder.path(), &["plot", name]);
        assert!(stderr.contains("--force"), "{stderr}");
        let again = format!("{name}-again");
        expect(0, folder.path(), &["plot", name, "--out", &again]);
        expect(0, folder.path(), &["plot", name, "--force"]);
        let mut count = 0;
        for entry in fs::read_dir(folder.path().join(name).join("plots")).unwrap() {
            let first = entry.unwrap().path();
            let second = folder.path().join(&again).join(first.file_name().unwrap());
            let bytes = fs::read(&first).unwrap();
            assert!(bytes.starts_with(b"\x89PNG"));
            assert!(bytes == fs::read(second).unwrap(), "{} differs", first.display());
            count += 1;
        }
        assert!(count >= 5, "{name} has {count} plots");
    }
}

#[test]
fn a_folder_without_a_run_is_refused() {
    let folder = folder();
    let (_, stderr) = expect(2, folder.path(), &["plot", "nowhere"]);
    assert!(stderr.contains("nowhere"), "{stderr}");
}

#[test]
fn several_runs_are_drawn_in_the_same_figures() {
    let folder = folder();
    let few = ["--quiet", "--set", "learning.updates=20", "--set", "accept={}", "--set", "output={}"];
    let learn = |name: &str, more: &[&str]| {
        expect(0, folder.path(), &[&["learn", &task("via_point.toml"), "--out", name][..], &few, more].concat());
    };
    learn("low", &[]);
    learn("high", &["--set", "via_point.0.position=[0.5,0.9]"]);
    let (_, stderr) = expect(2, folder.path(), &["plot", "low", "high"]);
    assert!(stderr.contains("--out"), "{stderr}");
    let (stdout, _) = expect(0, folder.path(), &["plot", "low", "high", "--out", "both"]);
    for name in ["cost", "stiffness", "damping", "disturbance", "path"] {
        let file = format!("{name}.png");
        assert!(stdout.contains(&file), "{stdout}");
        let both = fs::read(folder.path().join("both").join(&file)).unwrap();
        assert!(both != fs::read(folder.path().join("low/plots").join(&file)).unwrap(), "{name} shows one run only");
    }
    expect(0, folder.path(), &["plot", "low", "high", "--out", "again"]);
    let bytes = |place: &str| fs::read(folder.path().join(place).join("path.png")).unwrap();
    assert!(bytes("both") == bytes("again"));
    let (_, stderr) = expect(2, folder.path(), &["plot", "low", "low", "--out", "x"]);
    assert!(stderr.contains("named twice"), "{stderr}");

    expect(0, folder.path(), &[&["learn", &task("reach.toml"), "--out", "reach"][..], &few].concat());
    let (_, stderr) = expect(2, folder.path(), &["plot", "low", "reach", "--out", "x"]);
    assert!(stderr.contains("low has x [m], y [m], reach has x [m]"), "{stderr}");
}

#[test]
fn svg_holds_the_lines_and_letters_themselves_and_only_draws_what_is_named() {
    let folder = folder();
    let few = ["--quiet", "--set", "learning.updates=20", "--set", "accept={}", "--set", "output={}"];
    expect(0, folder.path(), &[&["learn", &task("cantilever.toml"), "--out", "c"][..], &few].concat());
    expect(0, folder.path(), &["plot", "c", "--format", "svg", "--only", "stiffness,deviation", "--out", "svg"]);
    let mut names: Vec<_> =
        fs::read_dir(folder.path().join("svg")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["deviation.svg", "stiffness.svg"]);
    let svg = read(folder.path().join("svg/stiffness.svg"));
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert!(svg.contains("aria-label=\"stiffness [N/m]\"") && !svg.contains("<text"), "letters are outlines");
    assert!(!svg.contains("NaN") && !svg.contains("inf"));
    let (_, stderr) = expect(2, folder.path(), &["plot", "c", "--only", "stifness", "--out", "x"]);
    assert!(stderr.contains("did you mean `stiffness`?") && stderr.contains("contact_force"), "{stderr}");
}
