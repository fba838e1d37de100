//! The motion of one axis of several rollouts at once, one per lane.

use hpf_core::admittance::Inertial;
use hpf_core::{ConfigError, Lanes, MovementState, PlannedReference, Real};

use super::profiles::Profiles;
use super::table::TILE;

/// What an axis' reference motion follows, in every lane.
#[derive(Clone, Debug)]
pub(super) struct Reference<const N: usize> {
    movement: PlannedReference<Lanes<N>>,
    /// The law of the tool, where it has inertia.
    pub(super) inertial: Option<Inertial<Lanes<N>>>,
}

impl<const N: usize> Reference<N> {
    /// The same in every lane; `numbers` are start, goal, alpha and forcing scale, `inertia` the mass of the tool and the
    /// largest stiffness and damping of its law.
    pub(super) fn new(
        numbers: [f64; 4],
        inertia: Option<[f64; 3]>,
        dt: f64,
        duration: f64,
    ) -> Result<Self, ConfigError> {
        let [start, goal, alpha, scale] = numbers.map(Lanes::of);
        Ok(Self {
            movement: PlannedReference::new(start, goal, alpha, scale, Lanes::of(duration), Lanes::of(dt))?,
            inertial: inertia
                .map(|numbers| {
                    let [mass, stiffness, damping] = numbers.map(Lanes::of);
                    Inertial::new(mass, stiffness, damping, Lanes::of(dt))
                })
                .transpose()?,
        })
    }

    /// Scale of the forcing term.
    pub(super) fn forcing_scale(&self) -> f64 {
        self.movement.forcing_scale().to_f64()
    }

    /// Where the movement starts.
    pub(super) fn start(&self) -> Lanes<N> {
        self.movement.initial_state().position
    }
}

/// The reference and the gains at one sample.
#[derive(Clone, Copy)]
pub(super) struct Knot<const N: usize> {
    state: MovementState<Lanes<N>>,
    /// [m/s]
    pub(super) reference_velocity: Lanes<N>,
    /// [N/m]
    pub(super) stiffness: Lanes<N>,
    /// [N s/m]
    pub(super) damping: Lanes<N>,
}

impl<const N: usize> Knot<N> {
    #[inline(always)]
    pub(super) fn reference_position(&self) -> Lanes<N> {
        self.state.position
    }
}

/// All signals of one axis at one sample, in the units of [`crate::AxisTrace`] and [`crate::ContactTrace`].
pub(crate) struct Sample<const N: usize> {
    pub(crate) reference_position: Lanes<N>,
    pub(crate) reference_velocity: Lanes<N>,
    pub(crate) position: Lanes<N>,
    pub(crate) velocity: Lanes<N>,
    pub(crate) force: Lanes<N>,
    pub(crate) stiffness: Lanes<N>,
    pub(crate) damping: Lanes<N>,
    /// Deviation and contact force of an axis that touches something.
    pub(crate) contact: Option<[Lanes<N>; 2]>,
}

/// The tool on its way, from sample to sample.
pub(super) trait Tool<const N: usize> {
    /// The signals at sample `i`.
    fn sample(&self, i: usize, now: &Knot<N>) -> Sample<N>;

    /// Step `i`, with stiffness and damping at its middle.
    fn advance(&mut self, i: usize, now: &Knot<N>, next: &Knot<N>, middle: [Lanes<N>; 2]);
}

/// Takes the samples of an axis in their order.
pub(crate) trait Sink<const N: usize> {
    /// Takes sample `i`.
    fn take(&mut self, i: usize, sample: &Sample<N>);
}

/// Moves one axis for a step per entry of `drive`, the gate of its forcing term at mid-steps.
#[inline(always)]
pub(super) fn roll<const N: usize>(
    reference: &Reference<N>,
    drive: &[f64],
    profiles: &impl Profiles<N>,
    mut tool: impl Tool<N>,
    mut sink: impl Sink<N>,
) {
    let movement = reference.movement;
    let knot = |state: MovementState<Lanes<N>>, stiffness, damping| Knot {
        state,
        reference_velocity: movement.velocity(&state),
        stiffness,
        damping,
    };
    let [stiffness, damping] = profiles.start();
    let mut now = knot(movement.initial_state(), stiffness, damping);
    for (tile_index, drives) in drive.chunks(TILE).enumerate() {
        let first = tile_index * TILE;
        let tile = profiles.tile(first);
        for (j, &driven) in drives.iter().enumerate() {
            sink.take(first + j, &tool.sample(first + j, &now));
            let mut state = now.state;
            let goal = profiles.goal(first + j).unwrap_or(movement.goal());
            movement.step(&mut state, goal, Lanes::of(driven), tile.movement[j]);
            let ([middle_stiffness, stiffness], [middle_damping, damping]) = (tile.stiffness[j], tile.damping[j]);
            let next = knot(state, stiffness, damping);
            tool.advance(first + j, &now, &next, [middle_stiffness, middle_damping]);
            now = next;
        }
    }
    sink.take(drive.len(), &tool.sample(drive.len(), &now));
}
