//! Where what was told leads: the one way on, for what has just been told and for what is told again.

use super::{ActiveMethod, Learner, Session};
use crate::auto::{FallBack, Patience};
use crate::{Exhausted, History, LearnError, Note, Price, Progress, Record, TerminationReason};

impl Session {
    /// Goes where `record` led before; the records of a session in their order lead to where it was.
    ///
    /// # Errors
    /// [`LearnError::WrongRecord`] where another problem or method was recorded; otherwise as for [`Session::tell`].
    pub fn replay(&mut self, record: &Record) -> Result<Option<Progress>, LearnError> {
        if self.over.is_some() {
            return Err(LearnError::WrongRecord);
        }
        let progress = match record {
            Record::Costs(prices) if self.due.is_some() => {
                self.evaluated(prices.first().ok_or(LearnError::WrongRecord)?)?
            }
            record if self.due.is_none() => self.learned(record)?,
            _ => return Err(LearnError::WrongRecord),
        };
        self.look_ahead();
        match &self.seek {
            Some(seek) if self.over.is_some() => Err(seek.failed()),
            _ => Ok(progress),
        }
    }

    /// Takes what the outcome that is due was found to cost.
    fn evaluated(&mut self, price: &Price) -> Result<Option<Progress>, LearnError> {
        let due = self.due.take().expect("one is due");
        if due.update == 0 {
            return self.started(price);
        }
        self.history.rollouts += self.motions;
        Ok(Some(self.keep(due.priced(price))))
    }

    /// Takes what the start cost; `None` where it failed and others are tried.
    fn started(&mut self, price: &Price) -> Result<Option<Progress>, LearnError> {
        self.history.rollouts = self.motions;
        if !price.total.is_finite() {
            let plan = self.plan.take().ok_or(LearnError::BadStart)?;
            self.history.rejected += 1;
            self.seek = Some(plan.seek(&self.history.initial.weights));
            return Ok(None);
        }
        self.plan = None;
        let initial = Progress { rollouts: self.motions, ..self.history.initial.clone() }.priced(price);
        (self.history.initial, self.history.best) = (initial.clone(), initial.clone());
        Ok(Some(initial))
    }

    /// Takes what motions near a start that failed cost: the first that did not fail is where learning begins.
    fn sought(&mut self, record: &Record) -> Result<Option<Progress>, LearnError> {
        let (Some(mut seek), Record::Costs(prices)) = (self.seek.take(), record) else {
            return Err(LearnError::WrongRecord);
        };
        let samples = seek.take(prices.len()).ok_or(LearnError::WrongRecord)?;
        self.history.rollouts += prices.len() * self.motions;
        self.history.rejected += prices.iter().filter(|price| !price.total.is_finite()).count();
        let Some((weights, price)) = samples.into_iter().zip(prices).find(|(_, price)| price.total.is_finite()) else {
            if seek.is_over() {
                return Err(seek.failed());
            }
            self.seek = Some(seek);
            return Ok(None);
        };
        self.method = seek.active(weights.clone())?;
        self.history.notes.push(Note::Sought(seek.tried()));
        let initial =
            Progress { weights, rollouts: self.history.rollouts, ..self.history.initial.clone() }.priced(price);
        (self.history.initial, self.history.best) = (initial.clone(), initial.clone());
        Ok(Some(initial))
    }

    /// Keeps an evaluation.
    fn keep(&mut self, progress: Progress) -> Progress {
        if progress.total < self.history.best.total {
            self.history.best = progress.clone();
        }
        progress
    }

    /// Where learning has led with the motions made so far, its cost not known.
    pub(super) fn outcome(&self, weights: Vec<f64>, exploration: f64) -> Progress {
        let History { updates: update, rollouts, .. } = self.history;
        Progress { update, rollouts, total: f64::INFINITY, terms: Vec::new(), exploration, weights }
    }

    /// Has `outcome` evaluated.
    fn evaluate(&mut self, outcome: Progress) {
        self.due = Some(Progress { rollouts: outcome.rollouts + self.motions, ..outcome });
    }

    /// Takes the record of a batch.
    fn learned(&mut self, record: &Record) -> Result<Option<Progress>, LearnError> {
        self.batch = None;
        if self.seek.is_some() {
            return self.sought(record);
        }
        match (&mut self.method, record) {
            (
                ActiveMethod::Pi2(learner) | ActiveMethod::Polish(learner, _),
                Record::Update { update, weights, spread, exploration, rejected, cheapest },
            ) => {
                if [weights, spread].iter().any(|list| list.len() != learner.weights().len()) {
                    return Err(LearnError::WrongRecord);
                }
                learner.restore(*update, weights, spread);
                let weights = weights.clone();
                self.history.rollouts += self.rollouts * self.motions;
                self.history.rejected += rejected;
                if let ActiveMethod::Polish(..) = self.method {
                    self.cheapest.clone_from(cheapest);
                    return Ok(self.end_update(*exploration));
                }
                self.history.updates += 1;
                self.evaluate(self.outcome(weights, *exploration));
                Ok(None)
            }
            (ActiveMethod::Signals(..), Record::Signals { prices, signals }) => self.answered(prices, signals),
            (ActiveMethod::Model(..), Record::Signals { prices, signals }) => self.moved(prices, signals),
            (ActiveMethod::CmaEs(learner), Record::Costs(prices)) => {
                if prices.len() != learner.ask().len() {
                    return Err(LearnError::WrongRecord);
                }
                let costs: Vec<f64> = prices.iter().map(|price| price.total).collect();
                let (exploration, samples) = (learner.exploration(), learner.ask().to_vec());
                let rejected = match learner.tell(&costs) {
                    Ok(rejected) => rejected,
                    Err(reason) => return Err(self.failed(reason)),
                };
                self.history.rejected += rejected;
                self.history.rollouts += prices.len() * self.motions;
                self.offer(&samples, prices);
                Ok(self.end_update(exploration))
            }
            _ => Err(LearnError::WrongRecord),
        }
    }

    /// Takes the record of a motion that a model proposed.
    fn moved(&mut self, prices: &[Price], motions: &[Vec<f64>]) -> Result<Option<Progress>, LearnError> {
        let (ActiveMethod::Model(learner, _), [price], [motion]) = (&self.method, prices, motions) else {
            return Err(LearnError::WrongRecord);
        };
        if motion.len() != learner.shown() {
            return Err(LearnError::WrongRecord);
        }
        let samples = learner.ask().to_vec();
        let is_start = self.history.rollouts == 0;
        let initial = if is_start { self.started(price)? } else { None };
        if self.seek.is_some() {
            return Ok(None);
        }
        self.history.rollouts += if is_start { 0 } else { self.motions };
        let ActiveMethod::Model(learner, _) = &mut self.method else { unreachable!("matched above") };
        let (update, radius) = (learner.update(), learner.radius());
        self.history.rejected += learner.tell(price.total, motion);
        if learner.update() == update {
            return Ok(initial);
        }
        self.offer(&samples, prices);
        Ok(self.end_update(radius))
    }

    /// Takes the record of a batch of Gauss-Newton.
    fn answered(&mut self, prices: &[Price], signals: &[Vec<f64>]) -> Result<Option<Progress>, LearnError> {
        let ActiveMethod::Signals(learner) = &self.method else { return Err(LearnError::WrongRecord) };
        let count = prices.len();
        let fits = (1..=learner.ask().len()).contains(&count)
            && signals.len() == count
            && signals.iter().all(|signals| signals.len() == learner.signals());
        if !fits {
            return Err(LearnError::WrongRecord);
        }
        let samples = learner.ask()[..count].to_vec();
        let is_start = self.history.rollouts == 0;
        let initial = if is_start { self.started(&prices[0])? } else { None };
        if self.seek.is_some() {
            // What came of the rest of the batch says nothing of another start.
            self.history.rollouts += (count - 1) * self.motions;
            self.history.rejected += prices[1..].iter().filter(|price| !price.total.is_finite()).count();
            return Ok(None);
        }
        self.history.rollouts += (count - usize::from(is_start)) * self.motions;
        self.offer(&samples, prices);
        let ActiveMethod::Signals(learner) = &mut self.method else { unreachable!("matched above") };
        let (update, reach, was_coupled) = (learner.update(), learner.reach(), learner.is_coupled());
        self.history.rejected += learner.tell(signals);
        if learner.is_coupled() && !was_coupled {
            self.history.notes.push(Note::Coupled);
        }
        let is_updated = learner.update() > update;
        Ok(if is_updated { self.end_update(reach) } else { initial })
    }

    fn offer(&mut self, samples: &[Vec<f64>], prices: &[Price]) {
        for (sample, price) in samples.iter().zip(prices).filter(|(_, price)| price.total.is_finite()) {
            if self.cheapest.as_ref().is_none_or(|(_, best)| price.total < best.total) {
                self.cheapest = Some((sample.clone(), price.clone()));
            }
        }
    }

    /// Ends an update whose motions are evaluations, or of which the cheapest is yet to be evaluated.
    fn end_update(&mut self, exploration: f64) -> Option<Progress> {
        self.history.updates += 1;
        let (weights, price) = self.cheapest.take()?;
        let outcome = self.outcome(weights, exploration);
        if self.is_random {
            self.evaluate(outcome);
            return None;
        }
        Some(self.keep(outcome.priced(&price)))
    }

    /// Finds out whether a batch is to follow, and of what.
    fn look_ahead(&mut self) {
        if self.due.is_some() {
            return;
        }
        if self.seek.is_some() {
            self.over = self.limit();
            return;
        }
        // What comes next may have nothing to learn, either.
        loop {
            let exhausted = match &self.method {
                ActiveMethod::Signals(learner) => learner.exhausted(),
                ActiveMethod::Model(learner, _) => learner.exhausted(),
                _ => None,
            };
            match exhausted {
                Some(reason) if self.over.is_none() => self.exhaust(reason),
                _ => break,
            }
        }
        let best = self.history.best.total;
        if let ActiveMethod::Polish(learner, patience) = &mut self.method
            && patience.count(learner.update(), best)
        {
            self.over = Some(TerminationReason::Exhausted(Exhausted::NothingImproves));
        }
        if self.over.is_none() {
            self.over = self.limit();
            if self.over == Some(TerminationReason::Rollouts) && self.history.updates == 0 {
                self.history.notes.push(Note::TooFew);
            }
        }
    }

    /// Ends learning from a model, signals or costs, and hands over to what comes after it.
    fn exhaust(&mut self, reason: Exhausted) {
        self.history.best = self.history().best;
        self.cheapest = None;
        if let ActiveMethod::Model(_, after) = &self.method {
            match after {
                Some(signals) => {
                    self.history.notes.push(Note::Signals(reason));
                    self.method = signals.active(self.history.best.weights.clone());
                }
                None => self.over = Some(TerminationReason::Exhausted(reason)),
            }
            return;
        }
        let ActiveMethod::Signals(learner) = &self.method else { return };
        let is_negative = self.history.updates == 0 && reason == Exhausted::NoSignals;
        let polish = |fall_back: &FallBack, scales: Vec<f64>| {
            let learner = fall_back.polish(scales, self.history.best.weights.clone());
            ActiveMethod::Polish(Box::new(learner), Patience::new(self.history.best.total))
        };
        let next = match &**learner {
            // Where even the smallest perturbations fail, samples of PI2 would, too.
            Learner::Signals(_, Some(_)) if reason == Exhausted::NoSignals => None,
            Learner::Signals(learner, Some(fall_back)) => {
                Some((Note::FellBack(reason), polish(fall_back, learner.scales())))
            }
            Learner::Signals(_, None) => None,
            Learner::StepCosts(..) if reason == Exhausted::NoSignals => None,
            Learner::StepCosts(learner, fall_back) => {
                Some((Note::FellBack(reason), polish(fall_back, learner.scales())))
            }
            Learner::Roots(learner, fall_back) if is_negative || learner.is_noisy() => {
                let note = if is_negative { Note::NegativeCosts } else { Note::FellBack(reason) };
                Some((note, polish(fall_back, learner.scales())))
            }
            Learner::Roots(_, fall_back) => {
                let learner = Learner::StepCosts(
                    Box::new(fall_back.step_costs(self.history.best.weights.clone())),
                    fall_back.clone(),
                );
                Some((Note::StepCosts(reason), ActiveMethod::Signals(Box::new(learner))))
            }
        };
        match next {
            Some((note, active)) => {
                self.history.notes.push(note);
                self.method = active;
            }
            None => self.over = Some(TerminationReason::Exhausted(reason)),
        }
    }
}
