//! Tasks whose rollouts a process makes.

use hpf_sim::task::Environment;
use hpf_sim::{Policy, Simulation, SimulationError, Task};

const POINT_MASS: &str = include_str!("../../../examples/process/point_mass.toml");

fn messages(text: &str) -> Vec<String> {
    let found = Task::parse(text).expect_err("a mistake");
    found.iter().map(|diagnostic| format!("{}; {}", diagnostic.message, diagnostic.help)).collect()
}

#[test]
fn a_process_has_defaults_and_is_nothing_to_simulate_but_the_plan() {
    let short = POINT_MASS
        .replace("workers = 2 ", "")
        .replace("timeout = 10.0", "")
        .replace("tries = 3 ", "")
        .replace("max_lost = 20 ", "");
    let task = Task::parse(&short).unwrap();
    let Some(Environment::Process(process)) = &task.environment else { panic!("no process") };
    assert_eq!((process.workers, process.timeout, process.tries, process.max_lost), (1, 60.0, 3, 20));
    let policy = Policy::initial(&task).unwrap();
    assert_eq!(Simulation::new(&task, &policy).unwrap_err(), SimulationError::Process);
    let planned = Simulation::new(&task.as_planned(), &policy).unwrap();
    let trace = planned.rollout(&policy.weights());
    assert_eq!(trace.axes[0].position, trace.axes[0].reference_position, "without forces the plan is followed");
}

#[test]
fn a_process_is_the_whole_environment() {
    let force = "[[disturbance]]\nkind = \"step\"\naxis = \"x\"\namplitude = 1.0\nstart = 0.1\n";
    assert!(messages(&format!("{POINT_MASS}{force}"))[0].contains("`disturbance` is simulated"));
    let wall = "[contact]\nkind = \"wall\"\naxis = \"x\"\nposition = 0.2\nstiffness = 1e3\nforce = 1.0\n";
    assert!(messages(&format!("{POINT_MASS}{wall}")).iter().any(|message| message.contains("`contact` is simulated")));
    assert!(messages(&format!("{POINT_MASS}[output]\nsnapshots = [0]\n"))[0].contains("is simulated"));
    let noise = format!("{POINT_MASS}[recording]\nforce_noise = 0.1\n");
    assert!(messages(&noise)[0].contains("`recording` is simulated"));
}

#[test]
fn numbers_of_a_process_have_bounds() {
    for (from, to, words) in [
        ("workers = 2 ", "workers = 0 ", "from 1 to 256"),
        ("timeout = 10.0", "timeout = 0.0", "above 0"),
        ("tries = 3 ", "tries = 0 ", "from 1 to 1000"),
        ("max_lost = 20 ", "max_lost = -1 ", "max_lost"),
        ("max_lost = 20 ", "max_lost = 2000000 ", "1000000"),
        ("tries = 3 ", "trys = 3 ", "did you mean `tries`"),
        ("kind = \"process\"", "kind = \"thread\"", "process"),
        ("[\"python3\", \"point_mass.py\"]", "[]", "command"),
        ("[\"python3\", \"point_mass.py\"]", "[\"\"]", "the name of the program is empty"),
    ] {
        assert!(POINT_MASS.contains(from), "{from}");
        let found = messages(&POINT_MASS.replacen(from, to, 1)).join("\n");
        assert!(found.contains(words), "{to}: {found}");
    }
}

#[test]
fn costs_of_its_own_need_no_weights() {
    let (before, rest) = POINT_MASS.split_once("[cost]").unwrap();
    let (_, after) = rest.split_once("[learning]").unwrap();
    assert!(Task::parse(&format!("{before}[learning]{after}")).is_ok());
}
