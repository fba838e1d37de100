//! Rollouts that are made outside of hpf, and in the same program.

use core::sync::atomic::{AtomicUsize, Ordering};

use hpf::files::parse_task;
use hpf::outside::{Answer, Broken, Kind, Maker, Measured, Motion};
use hpf::{Failure, Job, Nobody, learning};
use hpf_sim::{Policy, Simulation};

const TASK: &str = r#"
name = "outside"
duration = 1.0
rate = 50.0
environment = { kind = "process", command = ["(nobody)"] }
[[axis]]
name = "x"
start = 0.0
goal = 0.3
[stiffness]
initial = 100.0
min = 30.0
max = 400.0
[damping]
initial = 50.0
min = 10.0
max = 100.0
[cost]
goal = 1e4
stiffness = 1e-4
[learning]
method = "pi2"
updates = 5
rollouts = 5
"#;

/// Answers with the motion as planned, up to a motion at which it breaks off.
struct Planned {
    simulation: Simulation,
    kind: Kind,
    breaks_at: usize,
    made: AtomicUsize,
}

impl Planned {
    fn new(kind: Kind, breaks_at: usize) -> Self {
        let task = parse_task(TASK.into(), "task", "".as_ref(), &[]).unwrap().task.as_planned();
        let simulation = Simulation::new(&task, &Policy::initial(&task).unwrap()).unwrap();
        Self { simulation, kind, breaks_at, made: AtomicUsize::new(0) }
    }
}

impl Maker for Planned {
    fn kind(&self) -> Kind {
        self.kind
    }

    fn make(&self, motions: &[Motion]) -> Result<Vec<Answer>, Broken> {
        let answer = |motion: &Motion| {
            if self.made.fetch_add(1, Ordering::SeqCst) + 1 == self.breaks_at {
                return Err(Broken::Failed("the arm is unplugged".into()));
            }
            let trace = self.simulation.rollout(&motion.weights);
            Ok(match self.kind {
                Kind::Costs => Answer::Total(self.simulation.cost(&trace).total()),
                Kind::Residuals(_) => Answer::Residuals(vec![(2.0 * self.simulation.cost(&trace).total()).sqrt()]),
                Kind::Trace => Answer::Trace(
                    trace
                        .axes
                        .into_iter()
                        .map(|axis| Measured { position: axis.position, velocity: axis.velocity, force: axis.force })
                        .collect(),
                ),
            })
        };
        motions.iter().map(answer).collect()
    }
}

#[test]
fn costs_traces_and_residuals_of_a_maker_are_learned_from() {
    for kind in [Kind::Costs, Kind::Trace, Kind::Residuals(1)] {
        let loaded = parse_task(TASK.into(), "task", "".as_ref(), &[]).unwrap();
        let start = Policy::initial(&loaded.task).unwrap();
        let maker = Planned::new(kind, 0);
        let learned = learning::learn_from(&loaded, start, None, &Nobody, Some(&maker)).unwrap();
        assert!(learned.history.best.total < learned.history.initial.total);
        assert_eq!(learned.history.rollouts, maker.made.load(Ordering::SeqCst), "every motion counts");
    }
}

#[test]
fn a_run_whose_maker_broke_off_goes_on_to_the_same_policy() {
    let folder = tempfile::tempdir().unwrap();
    let learn = |name: &str, maker: &Planned| {
        let loaded = parse_task(TASK.into(), "task", "".as_ref(), &[]).unwrap();
        Job::of(loaded, None, Some(&folder.path().join(name)), false).unwrap().learn_with(&Nobody, Some(maker))
    };
    let whole = learn("whole", &Planned::new(Kind::Trace, 0)).unwrap();
    let Err(Failure::Work(why)) = learn("run", &Planned::new(Kind::Trace, 15)) else { panic!("it breaks off") };
    assert!(why.contains("the arm is unplugged"));
    let job = Job::resume(&folder.path().join("run"), false).unwrap();
    let resumed = job.learn_with(&Nobody, Some(&Planned::new(Kind::Trace, 0))).unwrap();
    assert_eq!(resumed.learned.run.policy, whole.learned.run.policy);
}

#[test]
fn a_maker_of_a_task_that_hpf_simulates_is_refused() {
    let text = TASK.replace("environment =", "# ");
    let loaded = parse_task(text, "task", "".as_ref(), &[]).unwrap();
    let start = Policy::initial(&loaded.task).unwrap();
    let learned = learning::learn_from(&loaded, start, None, &Nobody, Some(&Planned::new(Kind::Costs, 0)));
    assert!(matches!(learned, Err(Failure::Input(_))));
}
