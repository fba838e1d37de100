//! The arguments of `hpf imitate`.

use std::path::PathBuf;

use super::numbers::{not_negative, number, positive, whole};
use clap::{Args, ValueEnum};
use hpf::recordings::{AxisSource, Mapping, Preset, Source, units_of};
use hpf_sim::demonstration::{
    DampingFrom, DurationFrom, Fit, Follow, Imitation, Outline, ScaleBy, Smoothing, StiffnessFrom,
};
use hpf_sim::task::MAX_BASIS;

/// Examples of `hpf imitate --help`.
pub const HELP: &str = "\
Examples:
  hpf imitate tasks/demonstrations/wipe.csv
  hpf imitate tasks/demonstrations/reach_*.csv --name reach_softly
  hpf imitate tasks/demonstrations/wipe.csv --time time_s:s --axis across=x_m:m --name across
  hpf imitate tasks/demonstrations/insert_emg.csv --stiffness-max 600 --damping-from ratio --mass 2
  hpf imitate tasks/demonstrations/push.csv --stiffness-from force --path reference
  hpf imitate tasks/demonstrations/reach_1.csv --task tasks/reach.toml  # exit code 3: target missed
  hpf learn runs/wipe/task.toml --from runs/wipe --out runs/wipe_learned --quiet

Without options columns are read by their names; a file with others is refused with what is in it and the command that
may read it. Columns: time_s; for each axis NAME_m (or NAME_position_m), and if recorded NAME_reference_m, NAME_stiffness_n_m,
NAME_damping_n_s_m, NAME_force_n (of the environment on the tool), NAME_emg. For an axis in rad: NAME_rad,
NAME_stiffness_nm_rad, NAME_damping_nm_s_rad, NAME_torque_nm. Gains of such an axis are in N m/rad and N m s/rad.";

/// `hpf imitate`
#[derive(Args, Debug)]
pub struct Options {
    /// Demonstrations: text tables, MCAP bags of ROS 2, NumPy arrays, or run directories for their trajectories
    #[arg(value_name = "DEMO", required = true)]
    pub demonstrations: Vec<PathBuf>,
    /// Column of time and its unit, of s, ms, us, ns [default: by its name]
    #[arg(long, value_name = "COLUMN[:UNIT]")]
    time: Option<Source>,
    /// An axis, the column of its position and its unit, of m, mm, cm, deg, rad, ...; a column by its name, or #3 for the
    /// third [default: by their names]
    #[arg(long, value_name = "AXIS=COLUMN[:UNIT]")]
    axis: Vec<AxisSource>,
    /// The column of the force of the environment on the tool along an axis (torque about it), of N, kN, Nm
    #[arg(long, value_name = "AXIS=COLUMN[:UNIT]")]
    force_column: Vec<AxisSource>,
    /// Leave out columns that nobody knows
    #[arg(long)]
    ignore_rest: bool,
    /// Topic of a bag, or arrays of an archive; topics behind commas are brought to the times of the first
    #[arg(long, value_name = "TOPIC[,TOPIC]")]
    topic: Option<String>,
    /// Samples per second of recordings without time; a column of time is then not read [Hz]
    #[arg(long, value_name = "HZ", value_parser = positive, conflicts_with = "time")]
    sample_rate: Option<f64>,
    /// Units of columns that state none, such as mm,deg,ms
    #[arg(long, value_name = "UNITS", value_parser = units_of)]
    units: Option<Units>,
    /// Columns as a program writes them: ur, ur-joints, franka, franka-joints, tum, euroc, optitrack, lasa
    #[arg(long, value_name = "NAME")]
    preset: Option<Preset>,
    /// Leave out rows without numbers and fill gaps in by cubics, which is a guess
    #[arg(long)]
    bridge: bool,
    /// Cut off rest before and after the motion
    #[arg(long)]
    trim: bool,
    /// Task to imitate into: its axes, bases, bounds, duration, start and goal [default: one made for the demonstrations]
    #[arg(long, value_name = "TASK", conflicts_with_all = OF_THE_TASK)]
    pub task: Option<PathBuf>,
    /// Name of the task [default: of the first file]
    #[arg(long)]
    pub name: Option<String>,
    /// Override a key of the task, typed as in TOML; lists by position, from 0
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub set: Vec<String>,
    /// Path that the policy follows: where the tool went, or where it would have been without force
    #[arg(long, value_enum, default_value = "position", value_name = "PATH")]
    path: PathKind,
    /// Regression
    #[arg(long, value_enum, default_value = "ridge", value_name = "KIND")]
    fit: FitKind,
    /// Penalty of the regression of the movement, relative to the forcing scale squared
    #[arg(long, default_value = "1e-9", value_name = "X", value_parser = not_negative)]
    penalty: f64,
    /// Cut-off of the zero-phase low-pass on positions [Hz], or off [default: 2 (basis - 1)/duration]
    #[arg(long, value_name = "HZ|off", value_parser = smoothing)]
    smooth: Option<Smoothing>,
    /// Basis functions of each primitive
    #[arg(long, default_value_t = 20, value_name = "N", value_parser = whole(2..=MAX_BASIS))]
    basis: usize,
    /// Decay of the phase: s(T) = exp(-decay) [default: ln 100]
    #[arg(long, value_name = "X", value_parser = number)]
    decay: Option<f64>,
    /// Spring factor of the movement [default: 25]
    #[arg(long, value_name = "X", value_parser = number)]
    alpha: Option<f64>,
    /// Scale of the forcing term [default: goal, or range where an axis ends near its start]
    #[arg(long, value_enum, value_name = "KIND")]
    scaling: Option<Scale>,
    /// Duration of the policy [s], or mean or first of the demonstrations
    #[arg(long, default_value = "mean", value_name = "S|mean|first", value_parser = duration)]
    duration: DurationFrom,
    /// Control rate [Hz] [default: that of the demonstrations]
    #[arg(long, value_name = "HZ", value_parser = positive)]
    rate: Option<f64>,
    /// Via points on the mean path in the task, which keep later learning to it
    #[arg(long, default_value_t = 4, value_name = "N", value_parser = whole(0..=1000_u16))]
    via_points: u16,
    /// Source of stiffness [default: columns, else emg, else spread of several, else constant]
    #[arg(long, value_enum, value_name = "SOURCE")]
    stiffness_from: Option<StiffnessSource>,
    /// Constant stiffness, and where learning starts without another [N/m] [default: 100, within the bounds]
    #[arg(long, value_name = "N/m", value_parser = positive)]
    stiffness: Option<f64>,
    /// Smallest stiffness [N/m]
    #[arg(long, default_value_t = 30.0, value_name = "N/m", value_parser = positive)]
    stiffness_min: f64,
    /// Largest stiffness [N/m]
    #[arg(long, default_value_t = 400.0, value_name = "N/m", value_parser = positive)]
    stiffness_max: f64,
    /// Source of damping [default: columns, else force where stiffness is from force, else constant]
    #[arg(long, value_enum, value_name = "SOURCE")]
    damping_from: Option<DampingSource>,
    /// Constant damping [N s/m] [default: 50, within the bounds]
    #[arg(long, value_name = "N s/m", value_parser = positive)]
    damping: Option<f64>,
    /// Smallest damping [N s/m]
    #[arg(long, default_value_t = 10.0, value_name = "N s/m", value_parser = positive)]
    damping_min: f64,
    /// Largest damping [N s/m]
    #[arg(long, default_value_t = 100.0, value_name = "N s/m", value_parser = positive)]
    damping_max: f64,
    /// Damping ratio for --damping-from ratio, 1 is critical
    #[arg(long, default_value_t = 1.0, value_name = "X", value_parser = positive)]
    damping_ratio: f64,
    /// Mass for --damping-from ratio [kg]
    #[arg(long, default_value_t = 1.0, value_name = "KG", value_parser = positive)]
    mass: f64,
    /// Cut-off of the envelope of muscle activity [Hz]
    #[arg(long, default_value_t = 3.0, value_name = "HZ", value_parser = positive)]
    emg_cutoff: f64,
    /// Window for gains from force [s] [default: a tenth of the duration]
    #[arg(long, value_name = "S", value_parser = positive)]
    window: Option<f64>,
}

/// One value of the argument, not a list of them.
type Units = Vec<hpf::recordings::UnitWord>;

/// What a task named with `--task` decides.
const OF_THE_TASK: [&str; 13] = [
    "basis",
    "decay",
    "alpha",
    "scaling",
    "duration",
    "rate",
    "via_points",
    "stiffness",
    "stiffness_min",
    "stiffness_max",
    "damping",
    "damping_min",
    "damping_max",
];

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PathKind {
    /// NAME_m or NAME_position_m
    Position,
    /// NAME_reference_m
    Reference,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum FitKind {
    /// All weights at once, with a small penalty
    Ridge,
    /// Locally weighted regression, as in the paper
    Lwr,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Scale {
    /// The way from start to goal, as in the paper
    Goal,
    /// 1
    Unit,
    /// The range of each axis in the demonstrations
    Range,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum StiffnessSource {
    /// The demonstrations' own columns
    Columns,
    /// The spread of several demonstrations: stiff where they agree
    Spread,
    /// Muscle activity
    Emg,
    /// Recorded force and how far the tool gave way
    Force,
    /// --stiffness
    Constant,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum DampingSource {
    /// The demonstrations' own columns
    Columns,
    /// Recorded force and how fast the tool gave way
    Force,
    /// --damping-ratio of the critical damping of --mass on the stiffness
    Ratio,
    /// --damping
    Constant,
}

fn smoothing(text: &str) -> Result<Smoothing, String> {
    if text == "off" { Ok(Smoothing::Off) } else { positive(text).map(Smoothing::CutOff) }
}

fn duration(text: &str) -> Result<DurationFrom, String> {
    match text {
        "mean" => Ok(DurationFrom::Mean),
        "first" => Ok(DurationFrom::First),
        time => positive(time).map(DurationFrom::Given),
    }
}

impl Options {
    /// What is read of a recording as what.
    pub fn mapping(&self) -> Mapping {
        Mapping {
            time: self.time.clone(),
            axes: self.axis.clone(),
            forces: self.force_column.clone(),
            ignore_rest: self.ignore_rest,
            topic: self.topic.clone(),
            sample_rate: self.sample_rate,
            units: self.units.clone().unwrap_or_default(),
            preset: self.preset,
            bridge: self.bridge,
            trim: self.trim,
        }
    }

    fn follow(&self) -> Follow {
        match self.path {
            PathKind::Position => Follow::Position,
            PathKind::Reference => Follow::Reference,
        }
    }

    /// How the policy is fitted.
    pub fn imitation(&self) -> Imitation {
        Imitation {
            follow: self.follow(),
            fit: match self.fit {
                FitKind::Ridge => Fit::Ridge,
                FitKind::Lwr => Fit::LocallyWeighted,
            },
            penalty: self.penalty,
            smoothing: self.smooth.unwrap_or_default(),
            stiffness: self.stiffness_from.map(|source| match source {
                StiffnessSource::Columns => StiffnessFrom::Columns,
                StiffnessSource::Spread => StiffnessFrom::Spread,
                StiffnessSource::Emg => StiffnessFrom::Emg,
                StiffnessSource::Force => StiffnessFrom::Force,
                StiffnessSource::Constant => StiffnessFrom::Constant,
            }),
            damping: self.damping_from.map(|source| match source {
                DampingSource::Columns => DampingFrom::Columns,
                DampingSource::Force => DampingFrom::Force,
                DampingSource::Ratio => DampingFrom::Ratio,
                DampingSource::Constant => DampingFrom::Constant,
            }),
            emg_cut_off: self.emg_cutoff,
            window: self.window,
            damping_ratio: self.damping_ratio,
            mass: self.mass,
        }
    }

    /// The task to make, called `name`.
    pub fn outline(&self, name: String) -> Outline {
        // A value left out lies within the bounds; one given outside them is reported.
        let gain = |initial: Option<f64>, paper: f64, min: f64, max: f64| {
            [initial.unwrap_or_else(|| paper.min(max).max(min)), min, max]
        };
        Outline {
            name,
            follow: self.follow(),
            duration: self.duration,
            rate: self.rate,
            basis: self.basis,
            decay: self.decay.unwrap_or_else(|| 100.0_f64.ln()),
            alpha: self.alpha.unwrap_or(hpf_core::movement::DEFAULT_ALPHA),
            scaling: self.scaling.map(|scale| match scale {
                Scale::Goal => ScaleBy::Goal,
                Scale::Unit => ScaleBy::Unit,
                Scale::Range => ScaleBy::Range,
            }),
            stiffness: gain(self.stiffness, 100.0, self.stiffness_min, self.stiffness_max),
            damping: gain(self.damping, 50.0, self.damping_min, self.damping_max),
            via_points: self.via_points.into(),
        }
    }
}
