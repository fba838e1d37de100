//! The lines of the protocol: what hpf sends, and which answers it accepts.

use std::borrow::Cow;

use hpf_learn::{Block, Draws, Parameters};
use hpf_sim::task::Task;
use hpf_sim::{Policy, Trace};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Value, json};

use crate::answers::Kind;

/// Version of the protocol.
pub const VERSION: u32 = 1;
/// Most characters of a line, or of what a process says of an error, shown in a message.
const SHOWN: usize = 120;
/// Bytes of an answer besides its numbers, at most.
const ENVELOPE: usize = 1 << 16;
/// Bytes of a number of an answer with what stands around it, at most: full digits take 26.
const NUMBER: usize = 32;

/// The first message to every worker, without its number.
pub struct Hello {
    task: String,
    seed: u64,
    duration: f64,
    steps: usize,
    policy: Value,
    axes: Vec<String>,
    /// Numbers of a trace.
    most_numbers: usize,
}

impl Hello {
    /// Of a task and the policy that learning starts from.
    pub fn new(task: &Task, policy: &Policy) -> Self {
        Self {
            task: task.name.clone(),
            seed: task.learning.seed,
            duration: task.duration,
            steps: task.steps(),
            policy: serde_json::from_str(&policy.to_json()).expect("a policy is JSON"),
            axes: task.axis.iter().map(|axis| axis.name.clone()).collect(),
            most_numbers: 3 * task.axis.len() * (task.steps() + 1),
        }
    }

    /// Longest line that is read from a worker [bytes]: every signal of every axis in full digits, and room.
    pub fn longest_line(&self) -> usize {
        ENVELOPE + NUMBER * self.most_numbers
    }

    /// Most residuals of a rollout: as many as a trace has numbers.
    pub fn most_residuals(&self) -> usize {
        self.most_numbers
    }

    /// The line for worker `number`.
    pub fn line(&self, number: usize) -> String {
        let hello = json!({
            "type": "hello", "protocol": VERSION, "task": self.task, "worker": number, "seed": self.seed,
            "duration": self.duration, "time_step": self.duration / self.steps as f64, "steps": self.steps,
            "policy": self.policy,
        });
        format!("{hello}\n")
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Ready {
    #[serde(rename = "type")]
    kind: String,
    protocol: u32,
    answers: Answers,
    residuals: Option<usize>,
}

#[derive(Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "snake_case")]
enum Answers {
    Costs,
    Trace,
    Residuals,
}

/// Reads the answer to a hello; a rollout has at most `most` residuals.
///
/// # Errors
/// What is wrong with it.
pub fn ready(line: &str, most: usize) -> Result<Kind, String> {
    let ready: Ready = read(line)?;
    if ready.kind != "ready" {
        return Err(nonsense(line, "its type is not \"ready\""));
    }
    if ready.protocol != VERSION {
        return Err(format!(
            "speaks version {} of the protocol; this program speaks version {VERSION}",
            ready.protocol
        ));
    }
    match (ready.answers, ready.residuals) {
        (Answers::Costs, None) => Ok(Kind::Costs),
        (Answers::Trace, None) => Ok(Kind::Trace),
        (Answers::Residuals, Some(count)) if (1..=most).contains(&count) => Ok(Kind::Residuals(count)),
        (Answers::Residuals, Some(count)) => {
            Err(format!("announces {count} residuals; a rollout of this task may have 1 to {most}"))
        }
        (Answers::Residuals, None) => Err(nonsense(line, "`residuals` must say how many there are")),
        (Answers::Costs | Answers::Trace, Some(_)) => {
            Err(nonsense(line, "`residuals` belongs to \"answers\": \"residuals\""))
        }
    }
}

#[derive(Serialize)]
struct Rollout<'a> {
    r#type: &'static str,
    id: u64,
    /// Null: held out for evaluation.
    draw: Option<usize>,
    axes: Vec<Axis<'a>>,
}

#[derive(Serialize)]
struct Axis<'a> {
    name: &'a str,
    /// Null: others at every step.
    weights: Option<Weights<'a>>,
    reference_position: &'a [f64],
    reference_velocity: &'a [f64],
    stiffness: &'a [f64],
    damping: &'a [f64],
}

#[derive(Serialize)]
struct Weights<'a> {
    movement: &'a [f64],
    stiffness: &'a [f64],
    damping: &'a [f64],
}

/// The line that asks for rollout `id` of the motion planned in `trace`.
pub fn request(
    id: u64,
    draws: Draws,
    parameters: Parameters<'_>,
    blocks: &[Block],
    trace: &Trace,
    hello: &Hello,
) -> String {
    let mut start = 0;
    let mut next = |block: &Block| {
        start += block.count;
        start - block.count..start
    };
    let ranges: Vec<_> = blocks.chunks_exact(3).map(|axis| [&axis[0], &axis[1], &axis[2]].map(&mut next)).collect();
    let axes = trace.axes.iter().zip(&hello.axes).zip(ranges).map(|((axis, name), ranges)| {
        let weights = match parameters {
            Parameters::Constant(all) => {
                let [movement, stiffness, damping] = ranges.map(|range| &all[range]);
                Some(Weights { movement, stiffness, damping })
            }
            Parameters::PerStep { .. } => None,
        };
        Axis {
            name,
            weights,
            reference_position: &axis.reference_position,
            reference_velocity: &axis.reference_velocity,
            stiffness: &axis.stiffness,
            damping: &axis.damping,
        }
    });
    let draw = match draws {
        Draws::Update(update) => Some(update),
        Draws::HeldOut => None,
    };
    let rollout = Rollout { r#type: "rollout", id, draw, axes: axes.collect() };
    serde_json::to_string(&rollout).expect("numbers and lists can be written") + "\n"
}

/// The result of a rollout.
#[derive(Debug, PartialEq)]
pub enum Answer {
    /// Its total cost.
    Total(f64),
    /// The cost of each step, and of the end.
    Steps(Vec<f64>, f64),
    /// What was measured, now in the trace.
    Trace,
    /// Numbers, half the sum of whose squares is the cost.
    Residuals(Vec<f64>),
    /// A failure, and its reason.
    Failed(String),
}

/// A number; null, which some write for a number that is none, is NaN.
fn number<'de, D: Deserializer<'de>>(value: D) -> Result<Option<f64>, D::Error> {
    Ok(Some(Option::deserialize(value)?.unwrap_or(f64::NAN)))
}

/// A list of such numbers.
fn numbers<'de, D: Deserializer<'de>>(list: D) -> Result<Vec<f64>, D::Error> {
    let list: Vec<Option<f64>> = Vec::deserialize(list)?;
    Ok(list.into_iter().map(|number| number.unwrap_or(f64::NAN)).collect())
}

/// A list of such numbers that may be left out.
fn some_numbers<'de, D: Deserializer<'de>>(list: D) -> Result<Option<Vec<f64>>, D::Error> {
    numbers(list).map(Some)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Done {
    r#type: String,
    id: u64,
    #[serde(default, deserialize_with = "number")]
    cost: Option<f64>,
    #[serde(default, deserialize_with = "some_numbers")]
    costs: Option<Vec<f64>>,
    #[serde(default, deserialize_with = "number")]
    terminal: Option<f64>,
    #[serde(default, deserialize_with = "some_numbers")]
    residuals: Option<Vec<f64>>,
    axes: Option<Vec<Measured>>,
    error: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Measured {
    #[serde(deserialize_with = "numbers")]
    position: Vec<f64>,
    #[serde(deserialize_with = "numbers")]
    velocity: Vec<f64>,
    #[serde(deserialize_with = "numbers")]
    force: Vec<f64>,
}

/// Reads the answer to rollout `id`; what was measured goes into `trace`.
///
/// # Errors
/// What is wrong with it.
pub fn answer(line: &str, id: u64, kind: Kind, trace: &mut Trace) -> Result<Answer, String> {
    let done: Done = read(line)?;
    let wrong = |why: &str| Err(nonsense(line, why));
    if done.r#type != "done" {
        return wrong("its type is not \"done\"");
    }
    if done.id != id {
        return wrong(&format!("its id is {}, asked for was {id}", done.id));
    }
    let Done { cost, costs, terminal, residuals, axes, error, .. } = done;
    match (kind, cost, costs, terminal, residuals, axes, error) {
        (_, None, None, None, None, None, Some(why)) => Ok(Answer::Failed(shown(&why))),
        (Kind::Costs, Some(cost), None, None, None, None, None) => Ok(Answer::Total(cost)),
        (Kind::Costs, None, Some(costs), terminal, None, None, None) => {
            if costs.len() != trace.steps() {
                return wrong(&format!("{} costs for {} steps", costs.len(), trace.steps()));
            }
            Ok(Answer::Steps(costs, terminal.unwrap_or(0.0)))
        }
        (Kind::Residuals(count), None, None, None, Some(residuals), None, None) => {
            if residuals.len() != count {
                return wrong(&format!("{} residuals, announced were {count}", residuals.len()));
            }
            Ok(if residuals.iter().all(|residual| residual.is_finite()) {
                Answer::Residuals(residuals)
            } else {
                Answer::Failed("a residual is not finite".into())
            })
        }
        (Kind::Trace, None, None, None, None, Some(axes), None) => measured(axes, trace).or_else(|why| wrong(&why)),
        (Kind::Costs, ..) => wrong("it needs one of cost, costs and error"),
        (Kind::Residuals(_), ..) => wrong("it needs one of residuals and error"),
        (Kind::Trace, ..) => wrong("it needs one of axes and error"),
    }
}

/// Puts what was measured in place of what was planned.
fn measured(axes: Vec<Measured>, trace: &mut Trace) -> Result<Answer, String> {
    let samples = trace.steps() + 1;
    if axes.len() != trace.axes.len() {
        return Err(format!("{} axes, asked for were {}", axes.len(), trace.axes.len()));
    }
    let mut is_finite = true;
    for (axis, signals) in axes.into_iter().zip(&mut trace.axes) {
        let lists = [
            ("position", axis.position, &mut signals.position),
            ("velocity", axis.velocity, &mut signals.velocity),
            ("force", axis.force, &mut signals.force),
        ];
        for (name, list, signal) in lists {
            if list.len() != samples {
                return Err(format!("{} numbers of {name} for {samples} samples", list.len()));
            }
            is_finite &= list.iter().all(|number| number.is_finite());
            *signal = list;
        }
    }
    Ok(if is_finite { Answer::Trace } else { Answer::Failed("a number of its trace is not finite".into()) })
}

/// Reads a line. Numbers that are none are taken as null, for that is what they become in JSON: Python writes `NaN`.
fn read<T: DeserializeOwned>(line: &str) -> Result<T, String> {
    serde_json::from_str(&nulled(line)).map_err(|error| nonsense(line, &error.to_string()))
}

/// `line` with null for NaN and infinities outside of texts.
fn nulled(line: &str) -> Cow<'_, str> {
    if !line.contains("NaN") && !line.contains("Infinity") {
        return Cow::Borrowed(line);
    }
    let mut text = String::with_capacity(line.len());
    let (mut rest, mut is_text) = (line, false);
    while let Some(first) = rest.chars().next() {
        let word = ["NaN", "Infinity", "-Infinity"].into_iter().find(|word| !is_text && rest.starts_with(word));
        // What follows a backslash in a text does not end it.
        let escaped = if is_text && first == '\\' { rest.chars().nth(1).map_or(0, char::len_utf8) } else { 0 };
        let length = word.map_or(first.len_utf8() + escaped, str::len);
        is_text ^= first == '"';
        text.push_str(if word.is_some() { "null" } else { &rest[..length] });
        rest = &rest[length..];
    }
    Cow::Owned(text)
}

fn nonsense(line: &str, why: &str) -> String {
    format!("printed `{}`, which is no answer: {}", shown(line), shown(why))
}

/// The beginning of what a process says; what would steer a terminal is spelled out.
fn shown(text: &str) -> String {
    let text = text.trim_end();
    let mut shown = String::new();
    for letter in text.chars().take(SHOWN) {
        if letter.is_control() { shown.extend(letter.escape_default()) } else { shown.push(letter) }
    }
    if text.chars().nth(SHOWN).is_some() {
        shown += "...";
    }
    shown
}

#[cfg(test)]
mod tests {
    use hpf_sim::AxisTrace;

    use super::*;

    fn trace() -> Trace {
        let signal = vec![0.0; 3];
        let axis = AxisTrace {
            position: signal.clone(),
            velocity: signal.clone(),
            force: signal.clone(),
            ..AxisTrace::default()
        };
        Trace { time: vec![0.0, 0.5, 1.0], axes: vec![axis], ..Trace::default() }
    }

    fn answered(line: &str, kind: Kind) -> Result<Answer, String> {
        answer(line, 7, kind, &mut trace())
    }

    #[test]
    fn costs_come_as_a_total_or_step_by_step() {
        assert_eq!(answered(r#"{"type":"done","id":7,"cost":2.5}"#, Kind::Costs), Ok(Answer::Total(2.5)));
        let steps = answered(r#"{"type":"done","id":7,"costs":[1,2],"terminal":3}"#, Kind::Costs);
        assert_eq!(steps, Ok(Answer::Steps(vec![1.0, 2.0], 3.0)));
        let steps = answered(r#"{"type":"done","id":7,"costs":[1,2]}"#, Kind::Costs);
        assert_eq!(steps, Ok(Answer::Steps(vec![1.0, 2.0], 0.0)));
    }

    #[test]
    fn a_trace_takes_the_place_of_the_plan() {
        let line = r#"{"type":"done","id":7,"axes":[{"position":[0,1,2],"velocity":[3,4,5],"force":[6,7,8]}]}"#;
        let mut found = trace();
        assert_eq!(answer(line, 7, Kind::Trace, &mut found), Ok(Answer::Trace));
        assert_eq!(found.axes[0].position, [0.0, 1.0, 2.0]);
        assert_eq!(found.axes[0].force, [6.0, 7.0, 8.0]);
    }

    #[test]
    fn numbers_that_are_none_are_costs_without_a_number() {
        for none in ["NaN", "Infinity", "-Infinity", "null"] {
            let line = format!(r#"{{"type":"done","id":7,"cost":{none}}}"#);
            assert!(matches!(answered(&line, Kind::Costs), Ok(Answer::Total(cost)) if cost.is_nan()), "{none}");
            let line = format!(r#"{{"type":"done","id":7,"costs":[{none},1],"terminal":{none}}}"#);
            let Ok(Answer::Steps(costs, end)) = answered(&line, Kind::Costs) else { panic!("{line}") };
            assert!(costs[0].is_nan() && costs[1] == 1.0 && end.is_nan());
            let line = format!(
                r#"{{"type":"done","id":7,"axes":[{{"position":[0,{none},2],"velocity":[3,4,5],"force":[6,7,8]}}]}}"#
            );
            assert!(matches!(answered(&line, Kind::Trace), Ok(Answer::Failed(_))));
        }
        let text = r#"{"type":"done","id":7,"error":"it said \"NaN\" and NaN"}"#;
        assert_eq!(answered(text, Kind::Costs), Ok(Answer::Failed("it said \"NaN\" and NaN".into())));
    }

    #[test]
    fn what_is_no_answer_is_shown_with_the_reason() {
        for (line, kind, words) in [
            ("hello", Kind::Costs, "`hello`"),
            (r#"{"type":"done","id":8,"cost":1}"#, Kind::Costs, "its id is 8, asked for was 7"),
            (r#"{"type":"done","id":7,"cost":1,"costs":[1,2]}"#, Kind::Costs, "needs one of"),
            (r#"{"type":"done","id":7,"cost":1}"#, Kind::Trace, "needs one of axes"),
            (r#"{"type":"done","id":7,"costs":[1]}"#, Kind::Costs, "1 costs for 2 steps"),
            (r#"{"type":"done","id":7,"price":1}"#, Kind::Costs, "price"),
            (r#"{"type":"ready","id":7,"cost":1}"#, Kind::Costs, "not \"done\""),
            (r#"{"type":"done","id":7,"axes":[]}"#, Kind::Trace, "0 axes"),
            (
                r#"{"type":"done","id":7,"axes":[{"position":[0],"velocity":[3,4,5],"force":[6,7,8]}]}"#,
                Kind::Trace,
                "1 numbers of position for 3 samples",
            ),
        ] {
            let refused = answered(line, kind).unwrap_err();
            assert!(refused.contains(words), "{refused}");
        }
        let long = answered(&"x".repeat(1000), Kind::Costs).unwrap_err();
        assert!(long.len() < 250 && long.contains("..."), "{long}");
    }

    #[test]
    fn another_version_of_the_protocol_is_refused() {
        assert_eq!(ready(r#"{"type":"ready","protocol":1,"answers":"trace"}"#, 9), Ok(Kind::Trace));
        assert!(ready(r#"{"type":"ready","protocol":2,"answers":"costs"}"#, 9).unwrap_err().contains("version 2"));
        assert!(ready(r#"{"type":"ready","protocol":1,"answers":"smoke"}"#, 9).unwrap_err().contains("smoke"));
    }

    #[test]
    fn residuals_are_as_many_as_were_announced() {
        let announced = |rest: &str| ready(&format!(r#"{{"type":"ready","protocol":1,"answers":{rest}}}"#), 9);
        assert_eq!(announced(r#""residuals","residuals":9"#), Ok(Kind::Residuals(9)));
        for (rest, words) in [
            (r#""residuals","residuals":10"#, "may have 1 to 9"),
            (r#""residuals","residuals":0"#, "may have 1 to 9"),
            (r#""residuals""#, "must say how many"),
            (r#""costs","residuals":3"#, "belongs to"),
        ] {
            assert!(announced(rest).unwrap_err().contains(words), "{rest}");
        }
        let kind = Kind::Residuals(2);
        let found = answered(r#"{"type":"done","id":7,"residuals":[3,-4]}"#, kind);
        assert_eq!(found, Ok(Answer::Residuals(vec![3.0, -4.0])));
        assert!(matches!(answered(r#"{"type":"done","id":7,"residuals":[3,NaN]}"#, kind), Ok(Answer::Failed(_))));
        assert!(answered(r#"{"type":"done","id":7,"residuals":[3]}"#, kind).unwrap_err().contains("announced were 2"));
        assert!(answered(r#"{"type":"done","id":7,"cost":3}"#, kind).unwrap_err().contains("needs one of residuals"));
        assert!(
            answered(r#"{"type":"done","id":7,"residuals":[1]}"#, Kind::Costs).unwrap_err().contains("needs one of")
        );
    }
}
