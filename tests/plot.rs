//! `hpf plot`

use std::fs;

use crate::support::{expect, folder, task};

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
