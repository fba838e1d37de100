//! What a build without features leaves out of a run is said, and nothing else changes.

use std::sync::Mutex;

use hpf::{Job, Prepared, Watch, trial};

/// Keeps the notes it hears.
#[derive(Default)]
struct Notes(Mutex<Vec<String>>);

impl Watch for Notes {
    fn note(&self, sentence: &str) {
        self.0.lock().unwrap().push(sentence.to_owned());
    }
}

impl Notes {
    /// Asserts that what is not there was named once, and nothing else.
    fn expect(self) {
        let left_out = [
            (cfg!(feature = "logs"), "log.mcap is left out: this build of hpf lacks the feature `logs`"),
            (cfg!(feature = "figures"), "plots/ is left out: this build of hpf lacks the feature `figures`"),
        ];
        let wanted: Vec<&str> = left_out.iter().filter(|(is_there, _)| !is_there).map(|(_, note)| *note).collect();
        assert_eq!(self.0.into_inner().unwrap(), wanted);
    }
}

#[test]
fn a_run_saved_without_log_or_figures_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let task = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tasks/reach.toml");
    let changes = ["learning.method=pi2".into(), "learning.updates=2".into()];

    let (learned, notes) = (folder.path().join("learned"), Notes::default());
    let job = Job::begin(task.as_ref(), &changes, None, Some(&learned), false).unwrap();
    job.learn(&notes).unwrap();
    notes.expect();

    let (saved, notes) = (folder.path().join("saved"), Notes::default());
    let prepared = Prepared::read(task.as_ref(), &changes).unwrap();
    let learned_in_memory = trial::learn(&prepared.loaded, &notes).unwrap();
    trial::save(&learned_in_memory, &prepared, true, &saved, &notes).unwrap();
    notes.expect();

    for run in [learned, saved] {
        assert_eq!(run.join("log.mcap").is_file(), cfg!(feature = "logs"));
        assert_eq!(run.join("plots/cost.png").is_file(), cfg!(feature = "figures"));
        for name in ["task.toml", "policy.json", "learning.csv", "trajectory.csv", "summary.json"] {
            assert!(run.join(name).is_file(), "{name} is always there");
        }
        hpf::Run::load(&run).unwrap();
    }
}
