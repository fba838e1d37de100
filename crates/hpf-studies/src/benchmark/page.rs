//! The comparison as Markdown, JSON and figures.

use core::fmt::Write as _;

use serde_json::{Value, json};

use super::study::{Result, Study};
use hpf::figure::{Drawing, Group, Member, short, sweep_cost};
use hpf::statistics::Spread;

const ABOUT: &str = "\
# Benchmarks: methods beside each other

```
hpf benchmark --out docs --force     # writes this page, its figures and benchmarks.json
```

No method is tuned to a task: each has its defaults, 20 rollouts per update, the `noise` of the task file and the same
budget of motions, evaluations included; `auto` learns from signals where it can. A cell is the number of motions until
an evaluation first cost no more than the level: median, and worst in brackets, over the seeds; `-` where that many
seeds never did. The levels are part of the program: on the paper's tasks and dmpbbo's, round costs known from
elsewhere; on the others, between what one seed of `pi2` or `auto` began and ended with. PI2 and its variants anneal
over the whole budget, so they reach a level late that they would reach sooner in a shorter run. Seconds are of one
thread, of the machine that ran the command with all its cores at work, and in proportion to motions within a run;
everything else is the same on every machine.
";

/// The whole page, after `seconds` of work.
pub fn markdown(study: &Study, seconds: f64) -> String {
    let mut text = ABOUT.to_owned();
    let seeds = match study.seeds.as_slice() {
        [one] => format!("Seed {one}"),
        all => format!("{} seeds, {} to {}", all.len(), all[0], all[all.len() - 1]),
    };
    let threads = rayon::current_num_threads();
    let _ = writeln!(
        text,
        "\n{seeds}; at most {} motions a run; {seconds:.0} s in all on {threads} threads.",
        study.motions
    );
    for results in study.by_task() {
        let target = results[0].target;
        let _ = write!(text, "\n## {}\n\n| method |", target.name);
        for level in target.levels {
            let _ = write!(text, " motions to {} | seconds |", short(level, 3));
        }
        text += " cost at the end |\n|---|---|---|---|---|---|---|---|\n";
        for result in results {
            let _ = write!(text, "| `{}` |", result.method);
            for level in target.levels {
                let reached = result.reached(level);
                let seconds = |value: f64| number(value, |value| format!("{value:.2}"));
                let motions = |value: f64| number(value, |value| format!("{value:.0}"));
                let _ = write!(text, " {} | {} |", cell(reached.motions, motions), cell(reached.seconds, seconds));
            }
            let _ = writeln!(text, " {} |", cell(result.last(), |value| number(value, |value| short(value, 3))));
        }
        let _ = writeln!(text, "\n![Cost by motions made](images/benchmarks/{}.png)", target.name);
    }
    text
}

fn cell(spread: Spread, number: impl Fn(f64) -> String) -> String {
    let (median, worst) = (number(spread.median), number(spread.largest));
    if median == worst { median } else { format!("{median} ({worst})") }
}

fn number(value: f64, form: impl Fn(f64) -> String) -> String {
    if value.is_finite() { form(value) } else { "-".into() }
}

/// The comparison for other programs; what was never reached is null.
pub fn json(study: &Study, seconds: f64) -> Value {
    let results = study.results.iter().map(|result| {
        let levels = result.target.levels.iter().map(|level| {
            let reached = result.reached(*level);
            json!({
                "cost": level,
                "seeds": reached.seeds,
                "motions": reached.motions.to_json(),
                "seconds": reached.seconds.to_json(),
            })
        });
        json!({
            "task": result.target.name,
            "method": result.method,
            "levels": levels.collect::<Vec<_>>(),
            "final_cost": result.last().to_json(),
        })
    });
    json!({
        "format": "hpf-benchmark",
        "version": 1,
        "seeds": study.seeds,
        "max_rollouts": study.motions,
        "threads": rayon::current_num_threads(),
        "total_s": seconds,
        "results": results.collect::<Vec<_>>(),
    })
}

/// A figure for each task: the cost over the motions made, by method.
pub fn figures(study: &Study) -> Vec<Drawing<'_>> {
    let drawing = |results: &'_ [Result]| {
        let member = |trial: &hpf::trial::Trial| Member {
            costs: trial.run.learning.iter().map(|row| (row.rollouts as f64, row.total)).collect(),
            measures: Vec::new(),
        };
        let groups: Vec<Group> = results
            .iter()
            .map(|result| Group {
                name: result.method.into(),
                short: result.method.into(),
                members: result.trials.iter().map(member).collect(),
            })
            .collect();
        Drawing::new(results[0].target.name, move || sweep_cost(&groups))
    };
    study.by_task().map(drawing).collect()
}
