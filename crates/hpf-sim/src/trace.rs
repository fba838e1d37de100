//! What a rollout leaves behind: one number per sample of every signal. Every table, log and picture reads it.

/// The signals of one rollout, at the start and after every step of the movement, then of the rest time after it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// Time [s].
    pub time: Vec<f64>,
    /// Phase s, 1 at the start.
    pub phase: Vec<f64>,
    /// Steps of the rest time after the movement; the movement has the others.
    pub rest_steps: usize,
    /// The signals of each axis, in axis order.
    pub axes: Vec<AxisTrace>,
    /// The signals of the contact, where there is one.
    pub contact: Option<ContactTrace>,
}

/// The signals of one axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AxisTrace {
    /// Reference position x_r [m].
    pub reference_position: Vec<f64>,
    /// Reference velocity x_r' [m/s].
    pub reference_velocity: Vec<f64>,
    /// Position of the tool [m].
    pub position: Vec<f64>,
    /// Velocity of the tool [m/s].
    pub velocity: Vec<f64>,
    /// Force that the admittance sees: disturbances, and for a contact its set-point less the contact force [N].
    pub force: Vec<f64>,
    /// Stiffness k [N/m].
    pub stiffness: Vec<f64>,
    /// Damping d [N s/m].
    pub damping: Vec<f64>,
}

/// The signals of the contact.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ContactTrace {
    /// The axis it acts on.
    pub axis: usize,
    /// How far along the contact the tool is [m].
    pub travel: Vec<f64>,
    /// How far the surface yields under the set-point force [m].
    pub deflection: Vec<f64>,
    /// Deviation of the tool from that [m].
    pub deviation: Vec<f64>,
    /// Force with which the tool presses [N].
    pub force: Vec<f64>,
    /// Force with which it is to press [N].
    pub set_point: f64,
}

impl AxisTrace {
    pub(crate) fn sized(samples: usize) -> Self {
        let signal = || vec![0.0; samples];
        Self {
            reference_position: signal(),
            reference_velocity: signal(),
            position: signal(),
            velocity: signal(),
            force: signal(),
            stiffness: signal(),
            damping: signal(),
        }
    }

    /// Mean acceleration over each step [m/s^2]: steps numbers.
    pub fn acceleration(&self, dt: f64) -> impl Iterator<Item = f64> {
        self.velocity.windows(2).map(move |pair| (pair[1] - pair[0]) / dt)
    }
}

impl Trace {
    /// Number of steps of the movement: its last sample is at the duration.
    pub fn steps(&self) -> usize {
        self.time.len().saturating_sub(1 + self.rest_steps)
    }

    /// Step of time [s].
    pub fn dt(&self) -> f64 {
        match *self.time {
            [first, second, ..] => second - first,
            _ => 0.0,
        }
    }

    /// A signal at `time` [s] of the movement, linear between its samples.
    pub fn sample(&self, signal: &[f64], time: f64) -> f64 {
        let at = (time / self.dt()).clamp(0.0, self.steps() as f64);
        let before = (at.floor() as usize).min(self.steps().saturating_sub(1));
        let share = at - before as f64;
        signal[before] + share * (signal[before + 1] - signal[before])
    }
}
