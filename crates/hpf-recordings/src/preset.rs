//! Columns as known programs name them.

use core::str::FromStr;

use crate::table::{Table, plain};

/// A program, or a data set, whose columns are known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Universal Robots, RTDE client: `timestamp`, `actual_TCP_pose_0` to `_2`, `actual_TCP_force_0` to `_2`.
    Ur,
    /// The same, the joints: `actual_q_0` to `_5`.
    UrJoints,
    /// Franka, libfranka's log or its states as columns: `O_T_EE[12]` to `[14]`.
    Franka,
    /// The same, the joints: `q[0]` to `[6]`.
    FrankaJoints,
    /// Trajectories of the TUM RGB-D benchmark: `timestamp tx ty tz qx qy qz qw`, without header.
    Tum,
    /// Ground truth of EuRoC: `#timestamp [ns], p_RS_R_x [m], ...`.
    Euroc,
    /// OptiTrack Motive, CSV export: the first rigid body's position.
    Optitrack,
    /// Strokes of the LASA handwriting set as text or array: t, x, y in s and mm.
    Lasa,
}

/// Presets by their name in options.
pub const PRESETS: [(&str, Preset); 8] = [
    ("ur", Preset::Ur),
    ("ur-joints", Preset::UrJoints),
    ("franka", Preset::Franka),
    ("franka-joints", Preset::FrankaJoints),
    ("tum", Preset::Tum),
    ("euroc", Preset::Euroc),
    ("optitrack", Preset::Optitrack),
    ("lasa", Preset::Lasa),
];

impl FromStr for Preset {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        PRESETS.iter().find(|(word, _)| *word == name).map(|(_, preset)| *preset).ok_or_else(|| {
            let names = PRESETS.map(|(word, _)| word).join(", ");
            format!("`{name}` is no preset; there are {names}")
        })
    }
}

/// What a preset reads: column, unit.
type Wanted = (usize, &'static str);

/// The columns that a preset reads of a table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Found {
    /// The column of time and its unit.
    pub time: Option<Wanted>,
    /// Names of axes, columns of their positions and units.
    pub axes: Vec<(String, usize, &'static str)>,
    /// Names of axes, columns of their forces and units.
    pub forces: Vec<(String, usize, &'static str)>,
}

impl Preset {
    /// Its name in options.
    pub fn name(self) -> &'static str {
        PRESETS.iter().find(|(_, preset)| *preset == self).map_or("", |(name, _)| name)
    }

    /// The columns it reads of `table`.
    ///
    /// # Errors
    /// The columns that it needs and the table lacks.
    pub fn find(self, table: &Table) -> Result<Found, String> {
        let find = |names: &[String]| -> Option<usize> {
            let at = |name: &String| table.columns.iter().position(|column| is_called(&column.name, name));
            names.iter().find_map(at)
        };
        let number = |at: usize| (at < table.columns.len()).then_some(at);
        let three = ["x", "y", "z"];
        let indexed = |stem: &str, first: usize, axes: &[&str], unit: &'static str| {
            let column = |(i, axis): (usize, &&str)| {
                let at = find(&[format!("{stem}_{}", first + i)])
                    .or_else(|| find(&[format!("state_{stem}_{}", first + i)]))?;
                Some(((*axis).to_owned(), at, unit))
            };
            axes.iter().enumerate().map(column).collect::<Option<Vec<_>>>()
        };
        let joints = ["j1", "j2", "j3", "j4", "j5", "j6", "j7"];
        let franka_time = || {
            let columns =
                [("time", "ms"), ("duration", "ms"), ("state_time", "ms"), ("time_s", "s"), ("timestamp", "s")];
            let found = columns.iter().find_map(|(name, unit)| find(&[(*name).to_owned()]).map(|at| (at, *unit)))?;
            // The robot counts milliseconds; what others log beside it is in seconds, with steps below a half.
            let values = &table.columns[found.0].values;
            let is_fine = values.windows(2).any(|pair| pair[1] - pair[0] > 0.0 && pair[1] - pair[0] < 0.5);
            Some((found.0, if is_fine { "s" } else { found.1 }))
        };
        let found = match self {
            Self::Ur => Found {
                time: find(&["timestamp".into()]).map(|at| (at, "s")),
                axes: indexed("actual_tcp_pose", 0, &three, "m").unwrap_or_default(),
                forces: indexed("actual_tcp_force", 0, &three, "n").unwrap_or_default(),
            },
            Self::UrJoints => Found {
                time: find(&["timestamp".into()]).map(|at| (at, "s")),
                axes: indexed("actual_q", 0, &joints[..6], "rad").unwrap_or_default(),
                ..Found::default()
            },
            Self::Franka => Found {
                time: franka_time(),
                axes: indexed("o_t_ee", 12, &three, "m").unwrap_or_default(),
                forces: indexed("o_f_ext_hat_k", 0, &three, "n").unwrap_or_default(),
            },
            Self::FrankaJoints => Found {
                time: franka_time(),
                axes: indexed("q", 0, &joints, "rad").unwrap_or_default(),
                ..Found::default()
            },
            Self::Tum => Found {
                time: number(0).map(|at| (at, "s")),
                axes: columns_from(1, table, &three, "m", 8),
                ..Found::default()
            },
            Self::Euroc => Found {
                time: number(0).map(|at| (at, "ns")),
                axes: columns_from(1, table, &three, "m", 4),
                ..Found::default()
            },
            Self::Optitrack => optitrack(table),
            Self::Lasa => Found {
                time: number(0).map(|at| (at, "s")),
                axes: columns_from(1, table, &three[..2], "mm", 3),
                ..Found::default()
            },
        };
        let expected = match self {
            Self::Ur => "timestamp and actual_TCP_pose_0 to actual_TCP_pose_2",
            Self::UrJoints => "timestamp and actual_q_0 to actual_q_5",
            Self::Franka => "time and O_T_EE[12] to O_T_EE[14]",
            Self::FrankaJoints => "time and q[0] to q[6]",
            Self::Tum => "eight columns: timestamp tx ty tz qx qy qz qw",
            Self::Euroc => "four columns or more: timestamp [ns] and p_x, p_y, p_z [m]",
            Self::Optitrack => "Time (Seconds) and the Position X, Y, Z of a rigid body",
            Self::Lasa => "three columns or more: t [s], x and y [mm]",
        };
        if found.time.is_none() || found.axes.is_empty() {
            return Err(format!("the preset {} reads {expected}, which are not all there", self.name()));
        }
        Ok(found)
    }
}

/// Whether a column is called so, whatever signs are between its letters and digits.
fn is_called(column: &str, name: &str) -> bool {
    plain(&crate::units::in_name(column).0) == name || plain(column) == name
}

fn columns_from(
    first: usize,
    table: &Table,
    axes: &[&str],
    unit: &'static str,
    least: usize,
) -> Vec<(String, usize, &'static str)> {
    if table.columns.len() < least {
        return Vec::new();
    }
    axes.iter().enumerate().map(|(i, axis)| ((*axis).to_owned(), first + i, unit)).collect()
}

/// The position of the first body, in the unit that the lines before the header state.
fn optitrack(table: &Table) -> Found {
    let lower = table.preamble.join(",").to_lowercase();
    let unit = [("millimeters", "mm"), ("centimeters", "cm"), ("meters", "m"), ("inches", "inch")];
    let stated = unit.iter().find(|(word, _)| lower.contains(&format!("length units,{word}")));
    let unit = stated.map_or("m", |(_, unit)| *unit);
    let time = table.columns.iter().position(|column| plain(&column.name).ends_with("time_seconds"));
    let is_axis = |name: &str, axis: &str| {
        let plain = plain(name);
        plain.ends_with(&format!("position_{axis}"))
    };
    let first = |axis: &str| table.columns.iter().position(|column| is_axis(&column.name, axis));
    let axes = ["x", "y", "z"].map(|axis| first(axis).map(|at| (axis.to_owned(), at, unit)));
    Found {
        time: time.map(|at| (at, "s")),
        axes: axes.into_iter().collect::<Option<Vec<_>>>().unwrap_or_default(),
        forces: Vec::new(),
    }
}
