//! `hpf schema`: the task file for editors.

use hpf_sim::task::Task;

use crate::cli::Common;
use crate::deliver::deliver;
use crate::outcome::Outcome;
use hpf::failure::Failure;

/// Runs `hpf schema`.
pub fn schema(common: &Common) -> Result<Outcome, Failure> {
    let mut schema = Task::schema();
    schema["title"] = "HPF task file".into();
    deliver(common, None, format!("{schema:#}\n").as_bytes(), |_| None)
}
