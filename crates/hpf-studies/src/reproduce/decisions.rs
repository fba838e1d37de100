//! Where the paper is silent or inconsistent, and what was decided.

use hpf_sim::environment::{Cantilever, cantilever::Curve};

use super::words::value;

/// A decision.
pub struct Decision {
    /// What it is about.
    pub subject: &'static str,
    /// What the paper has.
    pub paper: String,
    /// What is done here.
    pub ours: String,
}

/// Every decision; `beam` is that of Task 2.
pub fn decisions(beam: &Cantilever) -> Vec<Decision> {
    let swapped = Cantilever { width: beam.thickness, thickness: beam.width, ..beam.clone() };
    let tip = |beam: &Cantilever| value(beam.deflection_of(Curve::TipLoad, beam.length), "m");
    // The curves are farthest apart where F (x^2 (3 l - x)/6 - x^3/3)/(E I) is greatest: at two thirds of the beam.
    let gap = |x: f64| beam.deflection_of(Curve::TipLoad, x) - beam.deflection_of(Curve::MovingLoad, x);
    let gap = value(gap(2.0 / 3.0 * beam.length), "m");
    let rows = [
        ("sign of the phase (Eq. 4)", "no minus sign", "`tau s' = -alpha_s s`"),
        (
            "duration in the movement (Eq. 3, 7)",
            "tau once and twice",
            "`tau^2 x'' = alpha (beta (g - x) - tau x') + F`",
        ),
        ("basis", "centers and widths not given", "equally spaced in time, neighbours meet at 0.6; 20 functions"),
        ("start of the weights", "not given", "zero: the bare pull to the goal"),
        ("integration", "not given", "exact steps, parameters at mid-step: second order"),
        (
            "bounds of stiffness and damping",
            "given, how they are kept is not",
            "samples and weights are brought within them; no clip at run time",
        ),
        ("force of Task 1", "with the motion, then against it; no amplitude", "`10 N sin(2 pi t/T)` on both axes"),
        ("weights of the cost", "not given", "in the task files"),
        (
            "running cost (Eq. 22 to 24)",
            "a bare sum over steps",
            "an integral over time, so that weights do not change with the rate",
        ),
        ("contact force in the cost", "no such term", "`cost.contact_force = 0.1`, see above"),
        (
            "contact",
            "not given",
            "beam and a contact of 1e6 N/m in series, unilateral, solved together with the admittance",
        ),
        ("start of Task 2", "not given", "in contact equilibrium, at rest"),
        ("travel along the beam", "not given", "minimum jerk from clamp to tip"),
        ("constant force", "on Eq. 1", "the admittance sees set-point less contact force, see above"),
        ("cost of a step (PI2)", "the full sum", "the cost to go; `credit = \"total\"` is the full sum"),
        (
            "temperature",
            "exp(-S/lambda), no lambda",
            "weights by the range of the costs, h = 10; `temperature = { lambda = ... }` is the paper's",
        ),
        (
            "exploration",
            "at every step",
            "once per rollout: smooth, and it needs a quarter of the scale; `exploration = \"step\"` is the paper's",
        ),
        (
            "rollouts per update, scale of the noise",
            "not given",
            "18 and in the task files; a rollout without noise follows each update, the best policy is kept",
        ),
        ("PI2 as the paper writes it", "", "`preset = \"paper\"`: noise at every step, lambda = 0.1, the full sum"),
    ];
    let row = |(subject, paper, ours): (&'static str, &str, &str)| Decision {
        subject,
        paper: paper.into(),
        ours: ours.into(),
    };
    let mut decisions: Vec<Decision> = rows.into_iter().map(row).collect();
    let beams = [
        Decision {
            subject: "second moment of area",
            paper: format!("width and thickness swapped: the tip sinks by {}", tip(&swapped)),
            ours: format!("`I = width thickness^3/12`: by {}", tip(beam)),
        },
        Decision {
            subject: "curve of the beam (Eq. 25)",
            paper: "of a beam loaded at its tip, whatever the tool's place".into(),
            ours: format!("both curves, a task each; a load where the tool is bends by F x³/(3 E I), up to {gap} less"),
        },
    ];
    let place = decisions.iter().position(|one| one.subject == "contact").unwrap_or(0);
    decisions.splice(place..place, beams);
    decisions
}
