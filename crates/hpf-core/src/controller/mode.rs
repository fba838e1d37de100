//! The modes of a controller and the one table of its transitions.
//!
//! | in \ on | start | hold | resume | stop | reset | tripped | input lost |
//! |---|---|---|---|---|---|---|---|
//! | **Idle** | Run | - | - | Stop | Idle | Stop | Idle |
//! | **Run** | - | Hold | Run | Stop | - | Stop | Fault |
//! | **Hold** | - | Hold | Run | Stop | - | Stop | Fault |
//! | **Stop** | - | - | - | Stop | Idle | Stop | Fault |
//! | **Fault** | - | - | - | Fault | Idle | Fault | Fault |
//!
//! A dash refuses the request: the mode stays and the refusal is counted.

/// What a controller does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Stands still where it was put, waiting for a start.
    Idle,
    /// Follows the skill; at the goal, holds it compliantly.
    Run,
    /// Pauses on the path, compliant; resumable.
    Hold,
    /// Stopped on the path for good, still compliant where it has moved before; latched until reset.
    Stop,
    /// Stopped and rigid, because an input is lost; latched until reset.
    Fault,
}

/// What moves a controller from mode to mode: five requests and two findings of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// Start of the movement.
    Start,
    /// Pause.
    Hold,
    /// End of the pause.
    Resume,
    /// Stop for good.
    Stop,
    /// Back to the beginning.
    Reset,
    /// A force above its trip level, or a robot that does not follow.
    Tripped,
    /// An input bad for longer than may be bridged, and the path is at rest.
    Lost,
}

impl Mode {
    /// The mode after `event`; none where it is refused.
    ///
    /// ```
    /// use hpf_core::controller::{Event, Mode};
    /// assert_eq!(Mode::Run.after(Event::Hold), Some(Mode::Hold));
    /// assert_eq!(Mode::Fault.after(Event::Resume), None); // only a reset leaves a fault
    /// ```
    pub const fn after(self, event: Event) -> Option<Self> {
        use Event::{Hold, Lost, Reset, Resume, Start, Stop, Tripped};
        match (self, event) {
            (Self::Idle, Start) => Some(Self::Run),
            (Self::Idle, Reset | Lost) | (Self::Stop | Self::Fault, Reset) => Some(Self::Idle),
            (Self::Run | Self::Hold, Hold) => Some(Self::Hold),
            (Self::Run | Self::Hold, Resume) => Some(Self::Run),
            (Self::Fault, Stop | Tripped | Lost) | (Self::Run | Self::Hold | Self::Stop, Lost) => Some(Self::Fault),
            (_, Stop | Tripped) => Some(Self::Stop),
            (Self::Run | Self::Hold, Start | Reset) => None,
            (Self::Idle | Self::Stop | Self::Fault, Hold | Resume) | (Self::Stop | Self::Fault, Start) => None,
        }
    }
}
