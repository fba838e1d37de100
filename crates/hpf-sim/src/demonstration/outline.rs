//! The task that a demonstrated policy belongs to, as the text of a task file that learning can go on with.

use core::fmt::Write as _;

use super::path::mean;
use super::signal::{grid, resample};
use super::{Demonstration, Follow};
use crate::task::MIN_GOAL_DISTANCE;

/// Where the duration of the policy comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DurationFrom {
    /// The mean of the recordings.
    Mean,
    /// The first recording.
    First,
    /// A given time [s].
    Given(f64),
}

/// What the forcing term is scaled by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleBy {
    /// A = goal - start, as in the paper.
    Goal,
    /// A = 1.
    Unit,
    /// A = the range of each axis in the recordings.
    Range,
}

/// What a task is to be, beside what the recordings say.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its name.
    pub name: String,
    /// The path to follow.
    pub follow: Follow,
    /// Its duration.
    pub duration: DurationFrom,
    /// Its rate [Hz]; left out, that of the recordings.
    pub rate: Option<f64>,
    /// Basis functions of each primitive.
    pub basis: usize,
    /// s(T) = exp(-decay).
    pub decay: f64,
    /// Spring factor.
    pub alpha: f64,
    /// Scale of the forcing term; left out, the goal's where it carries, else the range.
    pub scaling: Option<ScaleBy>,
    /// Initial, least and largest stiffness [N/m].
    pub stiffness: [f64; 3],
    /// Initial, least and largest damping [N s/m].
    pub damping: [f64; 3],
    /// Via points on the mean path.
    pub via_points: usize,
}

impl Default for Outline {
    /// What `hpf imitate` takes where it is told nothing: bounds of the gains as in the paper.
    fn default() -> Self {
        Self {
            name: "demonstration".into(),
            follow: Follow::Position,
            duration: DurationFrom::Mean,
            rate: None,
            basis: 20,
            decay: libm::log(100.0),
            alpha: hpf_core::movement::DEFAULT_ALPHA,
            scaling: None,
            stiffness: [100.0, 30.0, 400.0],
            damping: [50.0, 10.0, 100.0],
            via_points: 4,
        }
    }
}

/// Goal scaling carries where every axis ends at least this share of its range away from its start, in each recording.
const LEAST_TRAVEL: f64 = 0.1;
/// It scales the recordings of one motion alike only where none travels so many times as far as another, the same way.
const MOST_TRAVEL: f64 = 3.0;

impl Outline {
    /// Duration [s] as asked for, before it is fitted to a rate.
    fn wanted_duration(&self, demonstrations: &[Demonstration]) -> f64 {
        let duration = match self.duration {
            DurationFrom::First => demonstrations[0].duration(),
            DurationFrom::Mean => {
                demonstrations.iter().map(Demonstration::duration).sum::<f64>() / demonstrations.len() as f64
            }
            DurationFrom::Given(time) => time,
        };
        // To the nanosecond: time stamps that start anywhere leave roundings in their difference.
        if duration > 1e-6 { (duration * 1e9).round() / 1e9 } else { duration }
    }

    /// Duration [s] and rate [Hz], whose product is a whole number of steps. A rate that is given is kept: the duration
    /// is the nearest one that it cuts into whole steps. Without one, the duration is kept.
    fn time(&self, demonstrations: &[Demonstration]) -> [f64; 2] {
        let duration = self.wanted_duration(demonstrations);
        if let Some(rate) = self.rate {
            let steps = (duration * rate).round().max(2.0);
            let is_whole = (duration * rate - steps).abs() <= 1e-9 * steps;
            return [if is_whole { duration } else { steps / rate }, rate];
        }
        let samples = demonstrations.iter().map(|one| (one.time.len() - 1) as f64).sum::<f64>();
        let rate = (samples / demonstrations.len() as f64).round().max(2.0) / duration;
        [duration, if rate < 1e6 { (rate * 1e9).round() / 1e9 } else { rate }]
    }

    /// What the user should know of duration and rate: where they are not as asked for, or fit no usual rate.
    pub fn note(&self, demonstrations: &[Demonstration]) -> Option<String> {
        let ([duration, rate], wanted) = (self.time(demonstrations), self.wanted_duration(demonstrations));
        (duration != wanted).then(|| {
            format!("the duration is {duration} s instead of {wanted} s, so that {rate} Hz cut it into whole steps")
        })
    }

    /// The text of the task that `demonstrations`, at least one and all of the same axes, belong to.
    pub fn write(&self, demonstrations: &[Demonstration]) -> String {
        let first = &demonstrations[0];
        let count = demonstrations.len() as f64;
        let [duration, rate] = self.time(demonstrations);

        let mut text = format!(
            "# Made from {} by `hpf imitate`. Learning goes on from the demonstrated policy with:\n#\n\
             #   hpf learn task.toml --from policy.json --out DIR\n\n\
             name = \"{}\"\nduration = {duration:?} # s\nrate = {rate:?} # Hz\n",
            if demonstrations.len() == 1 { "a demonstration".into() } else { format!("{count} demonstrations") },
            self.name
        );
        let paths: Vec<Path> =
            first.axes.iter().map(|axis| Path::of(demonstrations, &axis.name, self.follow)).collect();
        for (axis, path) in first.axes.iter().zip(&paths) {
            let unit = axis.unit.symbol();
            let [start, goal] = path.ends;
            let _ = write!(
                text,
                "\n[[axis]]\nname = \"{}\"\nunit = \"{unit}\"\nstart = {start:?}\ngoal = {goal:?}\n",
                axis.name
            );
        }
        let carries = |path: &Path| {
            let far = |travel: f64| travel.abs() >= (LEAST_TRAVEL * path.range).max(MIN_GOAL_DISTANCE);
            let [least, most] = path.travel;
            let alike = least * most > 0.0 && least.abs().max(most.abs()) <= MOST_TRAVEL * least.abs().min(most.abs());
            far(path.ends[1] - path.ends[0]) && far(least) && far(most) && alike
        };
        let scaling = self.scaling.unwrap_or(if paths.iter().all(carries) { ScaleBy::Goal } else { ScaleBy::Range });
        let scaling = match scaling {
            ScaleBy::Goal => "\"goal\"".into(),
            ScaleBy::Unit => "\"unit\"".into(),
            // An axis that never moves has no range, and no forcing to scale.
            ScaleBy::Range => {
                let ranges = paths.iter().map(|path| if path.range > 0.0 { path.range } else { 1.0 });
                format!("{{ amplitude = {:?} }}", ranges.collect::<Vec<_>>())
            }
        };
        let _ = write!(
            text,
            "\n[phase]\ndecay = {:?}\n\n[movement]\nbasis = {}\nalpha = {:?}\nscaling = {scaling}\n",
            self.decay, self.basis, self.alpha
        );
        for (name, unit, [initial, min, max]) in
            [("stiffness", "N/m", self.stiffness), ("damping", "N s/m", self.damping)]
        {
            let _ = write!(
                text,
                "\n[{name}] # {unit}, N m for m on an axis in rad\nbasis = {}\ninitial = {initial:?}\nmin = {min:?}\nmax = {max:?}\n",
                self.basis
            );
        }
        for number in 1..=self.via_points {
            let share = number as f64 / (self.via_points + 1) as f64;
            let position: Vec<f64> = paths.iter().map(|path| path.at(share)).collect();
            let _ = write!(text, "\n[[via_point]]\ntime = {:?}\nposition = {position:?}\n", share * duration);
        }
        let via = if self.via_points > 0 { "via_point = 1e4\n" } else { "" };
        let _ = write!(
            text,
            "\n[cost] # keeps to the demonstrated path; add the forces of your task as [[disturbance]]\n\
             goal = 1e4\nend_velocity = 1e2\nrest = 1e4\n{via}acceleration = 1e-3\nstiffness = 1e-5\ndamping = 1e-4\n\n\
             [learning]\nmethod = \"auto\"\n"
        );
        text
    }
}

/// The mean path of one axis over normalised time.
struct Path {
    /// Mean start and mean end.
    ends: [f64; 2],
    /// Least and largest way from start to end of a recording.
    travel: [f64; 2],
    /// Largest range of a recording.
    range: f64,
    mean: Vec<f64>,
}

/// Steps of the mean path that via points are read from.
const STEPS: usize = 1000;

impl Path {
    fn of(demonstrations: &[Demonstration], name: &str, follow: Follow) -> Self {
        let (mut range, mut ends, mut paths) = (0.0_f64, [0.0; 2], Vec::new());
        let mut travel = [f64::INFINITY, f64::NEG_INFINITY];
        for demonstration in demonstrations {
            let Some(axis) = demonstration.axes.iter().find(|axis| axis.name == name) else { continue };
            let path = axis.path(follow);
            let (low, high) = path.iter().fold((f64::MAX, f64::MIN), |(a, b), x| (x.min(a), x.max(b)));
            range = range.max(high - low);
            let way = path[path.len() - 1] - path[0];
            travel = [way.min(travel[0]), way.max(travel[1])];
            ends[0] += path[0];
            ends[1] += path[path.len() - 1];
            paths.push(resample(&demonstration.time, path, grid(STEPS, demonstration.duration())));
        }
        let ends = ends.map(|sum| sum / paths.len() as f64);
        Self { ends, travel, range, mean: mean(paths.iter().map(Vec::as_slice)) }
    }

    fn at(&self, share: f64) -> f64 {
        self.mean[(share * STEPS as f64).round() as usize]
    }
}
