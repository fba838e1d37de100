//! Learning from a model: one proposed motion at a time, within a radius of the cheapest, to the bit when told again.

use hpf_learn::{
    AutoOptions, Block, Cost, Draws, Exhausted, LearnError, Method, Model, Parameters, Problem, Proposal, Record,
    Session, TerminationReason, Wants, learn_with,
};

/// The place of the least cost, found out from motions: `cost = (w - place)^2`, and a motion shows w - place.
#[derive(Clone, Debug)]
struct Line {
    place: Option<f64>,
    /// Added to what it expects.
    doubt: f64,
}

impl Model for Line {
    fn shown(&self) -> usize {
        1
    }

    fn learn(&mut self, weights: &[f64], motion: &[f64]) -> bool {
        self.place = Some(weights[0] - motion[0]);
        true
    }

    fn propose(&mut self, anchor: &[f64], radius: f64) -> Option<Proposal> {
        let way = (self.place? - anchor[0]).clamp(-radius, radius);
        let cost = |w: f64| (w - self.place.unwrap_or(0.0)).powi(2);
        let weights = vec![anchor[0] + way];
        Some(Proposal { expected: cost(weights[0]) + self.doubt, before: cost(anchor[0]), length: way.abs(), weights })
    }

    fn explanation(&self) -> String {
        "a line".into()
    }

    fn boxed(&self) -> Box<dyn Model> {
        Box::new(self.clone())
    }
}

struct Parabola {
    blocks: Vec<Block>,
    place: f64,
    fails_beyond: f64,
    has_model: bool,
}

impl Parabola {
    fn new(place: f64) -> Self {
        let block = Block {
            name: "w".into(),
            count: 1,
            features: vec![1.0],
            activations: vec![1.0],
            min: f64::NEG_INFINITY,
            max: f64::INFINITY,
            noise: 1.0,
        };
        Self { blocks: vec![block], place, fails_beyond: f64::INFINITY, has_model: true }
    }
}

impl Problem for Parabola {
    type Workspace = ();

    fn blocks(&self) -> &[Block] {
        &self.blocks
    }

    fn steps(&self) -> usize {
        1
    }

    fn terms(&self) -> &[&'static str] {
        &["height"]
    }

    fn workspace(&self) {}

    fn rollout(&self, _: Draws, parameters: Parameters<'_>, (): &mut (), cost: &mut Cost) {
        let w = parameters.at(0)[0];
        let height = if w > self.fails_beyond { f64::NAN } else { (w - self.place).powi(2) };
        *cost = Cost { running: vec![height], terminal: 0.0, terms: vec![height] };
    }

    fn model(&self) -> Option<Box<dyn Model>> {
        self.has_model.then(|| Box::new(Line { place: None, doubt: 0.0 }) as Box<dyn Model>)
    }

    fn observe(
        &self,
        (draws, _): (Draws, usize),
        parameters: Parameters<'_>,
        wants: Wants,
        workspace: &mut (),
        cost: &mut Cost,
        shown: &mut Vec<f64>,
    ) {
        self.rollout(draws, parameters, workspace, cost);
        assert_eq!(wants, Wants::Motion);
        *shown = vec![parameters.at(0)[0] - self.place];
    }
}

fn method() -> Method {
    Method::Model(AutoOptions { rollouts: 20, updates: 50, seed: 1 })
}

#[test]
fn each_motion_is_the_models_best_and_learning_ends_where_it_expects_no_gain() {
    let problem = Parabola::new(3.0);
    let mut costs = Vec::new();
    let history = learn_with(&problem, vec![0.0], &method(), None, |progress| {
        costs.push(progress.total);
        true
    })
    .unwrap();
    assert_eq!(costs, [9.0, 0.0], "the start, then the place that the first motion told of");
    assert_eq!(history.rollouts, 2);
    assert_eq!(history.stop, TerminationReason::Exhausted(Exhausted::NothingExpected));
}

#[test]
fn a_motion_goes_no_further_than_the_radius_which_doubles_while_motions_are_cheaper() {
    let problem = Parabola::new(1000.0);
    let mut places = Vec::new();
    learn_with(&problem, vec![0.0], &method(), None, |progress| {
        places.push(progress.weights[0]);
        true
    })
    .unwrap();
    assert_eq!(places, [0.0, 128.0, 384.0, 896.0, 1000.0]);
}

#[test]
fn a_motion_that_fails_is_rejected_and_the_next_one_goes_four_tenths_as_far() {
    let problem = Parabola { fails_beyond: 60.0, ..Parabola::new(100.0) };
    let mut places = Vec::new();
    let history = learn_with(&problem, vec![0.0], &method(), None, |progress| {
        places.push(progress.weights[0]);
        true
    })
    .unwrap();
    assert!((places[1] - 40.0).abs() < 1e-12, "{places:?}");
    assert!(history.rejected > 0 && history.best.weights[0] <= 60.0);
}

#[test]
fn a_session_told_its_records_again_asks_for_the_same_motion() {
    let problem = Parabola::new(1000.0);
    let mut session = Session::begin(&problem, vec![0.0], &method(), None).unwrap();
    let mut records: Vec<Record> = Vec::new();
    for _ in 0..4 {
        let w = session.ask().unwrap().samples[0].at(0)[0];
        let height = (w - 1000.0).powi(2);
        let cost = Cost { running: vec![height], terminal: 0.0, terms: vec![height] };
        records.push(session.tell(&[cost], &[vec![w - 1000.0]]).unwrap().record);
        let mut again = Session::begin(&problem, vec![0.0], &method(), None).unwrap();
        records.iter().for_each(|record| drop(again.replay(record).unwrap()));
        assert_eq!(again.history(), session.history());
        let asked = |session: &mut Session| session.ask().map(|ask| ask.samples[0].at(0)[0].to_bits());
        assert_eq!(asked(&mut again), asked(&mut session));
    }
    let wrong = Record::Signals { prices: vec![], signals: vec![] };
    assert_eq!(session.replay(&wrong), Err(LearnError::WrongRecord));
}

#[test]
fn a_problem_without_a_model_is_refused() {
    let problem = Parabola { has_model: false, ..Parabola::new(1.0) };
    assert_eq!(learn_with(&problem, vec![0.0], &method(), None, |_| true), Err(LearnError::NoModel));
}
