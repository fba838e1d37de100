//! Why a method finds nothing more to do.

/// Why learning ended by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exhausted {
    /// With the response freshly learned, no step lowers the cost.
    NothingImproves,
    /// The noise of the signals hides what smaller perturbations do.
    Noise,
    /// Even small perturbations leave no finite signals.
    NoSignals,
    /// The model of the environment, which predicts the motions made, expects no motion to be cheaper.
    NothingExpected,
    /// No model of the environment explains the motions made.
    Unexplained,
    /// The model of the environment predicts no cheaper motion that stays within the limits of safety.
    NothingSafe,
}

impl core::fmt::Display for Exhausted {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::NothingImproves => "nothing improves: no step lowers the cost, with the response freshly learned",
            Self::Noise => "nothing improves, and the noise of the signals hides what smaller perturbations do",
            Self::NoSignals => "no perturbation, however small, leaves finite signals",
            Self::NothingExpected => "the model of the environment expects no motion to be cheaper",
            Self::Unexplained => "no model of the environment explains the motions made",
            Self::NothingSafe => "the model of the environment predicts no cheaper motion within the limits of safety",
        })
    }
}
