//! `hpf reproduce`

use std::fs;

use crate::support::{expect, folder, json, read};

#[test]
fn every_figure_and_claim_of_the_paper_is_in_one_folder() {
    let folder = folder();
    let (stdout, _) = expect(0, folder.path(), &["reproduce", "--seeds", "1", "--quiet", "--out", "p"]);
    let p = folder.path().join("p");
    let figures = [
        "02_disturbance",
        "03_cost",
        "04_path",
        "05_stiffness",
        "06_damping",
        "07_beam",
        "08_cost",
        "09_stiffness",
        "10_damping",
        "11_path",
        "12_deviation",
    ];
    for figure in figures {
        let name = format!("figure_{figure}.png");
        assert!(stdout.contains(&name) && fs::read(p.join(&name)).unwrap().starts_with(b"\x89PNG"), "{name}");
    }
    let claims = json(p.join("claims.json"));
    assert_eq!((&claims["format"], &claims["version"]), (&"hpf-reproduction".into(), &1.into()));
    let holds = |place: &str| {
        let found = claims["claims"].as_array().unwrap().iter().find(|claim| claim["place"] == place);
        found.unwrap_or_else(|| panic!("no claim of {place}"))["holds"].as_bool().unwrap()
    };
    for place in [
        "Task 1, Figure 3",
        "Task 1, Figure 4",
        "Task 1, Figure 5",
        "Task 2, Figure 8",
        "Task 2, Figures 11, 12",
        "Task 2",
    ] {
        assert!(holds(place), "{place}");
    }
    // What does not reproduce is said to.
    assert!(!holds("Task 1, Figure 6") && !holds("Task 2, Eq. 1"));
    let literal = claims["claims"].as_array().unwrap().iter().find(|claim| claim["place"] == "Task 2, Eq. 1").unwrap();
    // Force by stiffness, 10 N / 400 N/m, less what is left of the approach after five seconds.
    let off = literal["numbers"][0]["median"].as_f64().unwrap();
    assert!((off - 0.025).abs() < 1e-5, "{off}");
    assert!(claims["decisions"].as_array().unwrap().len() > 15);

    let text = read(p.join("claims.md"));
    let block = text.split_once("\n\n").unwrap().1;
    assert_eq!(read(p.join("results.csv")).lines().filter(|line| line.contains(",cost,")).count(), 6);
    expect(0, folder.path(), &["plot", "p/cantilever", "--only", "deviation", "--out", "again"]);
    let again = fs::read(folder.path().join("again/deviation.png")).unwrap();
    assert!(again == fs::read(p.join("cantilever/plots/deviation.png")).unwrap());

    let page = "# Mine\n<!-- begin: hpf reproduce -->\nold\n<!-- end: hpf reproduce -->\nthe rest\n";
    fs::write(folder.path().join("page.md"), page).unwrap();
    let (_, stderr) = expect(1, folder.path(), &["reproduce", "--seeds", "1", "--quiet", "--check", "page.md"]);
    assert!(stderr.contains("page.md:3") && stderr.contains("--update"), "{stderr}");
    assert_eq!(read(folder.path().join("page.md")), page, "a check writes nothing");
    expect(0, folder.path(), &["reproduce", "--seeds", "1", "--quiet", "--update", "page.md", "--threads", "1"]);
    let updated = read(folder.path().join("page.md"));
    assert!(
        updated.contains(block) && updated.starts_with("# Mine\n") && updated.ends_with("\nthe rest\n"),
        "{updated}"
    );
}

#[test]
fn results_are_not_replaced_unasked_and_a_page_without_marks_is_refused_at_once() {
    let folder = folder();
    fs::create_dir(folder.path().join("p")).unwrap();
    fs::write(folder.path().join("p/thesis.txt"), "years").unwrap();
    let (_, stderr) = expect(2, folder.path(), &["reproduce", "--out", "p"]);
    assert!(stderr.contains("--force"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["reproduce", "--out", "p", "--force"]);
    assert!(stderr.contains("no reproduction"), "{stderr}");
    fs::write(folder.path().join("page.md"), "no marks").unwrap();
    let (_, stderr) = expect(2, folder.path(), &["reproduce", "--check", "page.md", "--json"]);
    assert!(stderr.contains("--json means nothing"), "{stderr}");
    let (_, stderr) = expect(2, folder.path(), &["reproduce", "--check", "page.md"]);
    assert!(stderr.contains("page.md") && stderr.contains("begin: hpf reproduce"), "{stderr}");
}
