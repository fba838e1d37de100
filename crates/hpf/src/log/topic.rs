//! The topics of a log.

use foxglove::messages::{FrameTransforms, Log, PoseInFrame, PosesInFrame, SceneUpdate};
use foxglove::{Encode, Schema};
use prost::Message;

use super::{proto, ros2};

/// A topic of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Pose of the tool.
    ToolPose,
    /// Pose it is to have.
    ReferencePose,
    /// The same as frames.
    Transforms,
    /// The whole path that it is to take.
    ReferencePath,
    /// The whole path that it takes.
    LearnedPath,
    /// What a 3D view shows.
    Scene,
    /// A few lines to read.
    Log,
    /// Every signal of the motion.
    State,
    /// Cost by learning update.
    Update,
    /// The axes as joints.
    Axes,
}

impl Topic {
    /// All topics, in the order of their channels.
    pub const ALL: [Self; 10] = [
        Self::ToolPose,
        Self::ReferencePose,
        Self::Transforms,
        Self::ReferencePath,
        Self::LearnedPath,
        Self::Scene,
        Self::Log,
        Self::State,
        Self::Update,
        Self::Axes,
    ];

    /// The name it is found by.
    pub fn name(self) -> &'static str {
        match self {
            Self::ToolPose => "/tool/pose",
            Self::ReferencePose => "/reference/pose",
            Self::Transforms => "/tf",
            Self::ReferencePath => "/path/reference",
            Self::LearnedPath => "/path/learned",
            Self::Scene => "/scene",
            Self::Log => "/log",
            Self::State => "/hpf/state",
            Self::Update => "/hpf/update",
            Self::Axes => "/hpf/axes",
        }
    }

    /// How its messages are encoded.
    pub fn encoding(self) -> &'static str {
        match self {
            Self::Axes => "cdr",
            _ => "protobuf",
        }
    }

    /// What its messages are.
    pub fn schema(self) -> Schema {
        let own = |name: &str| Schema::new(name, "protobuf", proto::descriptor().encode_to_vec());
        let foxglove = match self {
            Self::State => return own("hpf.State"),
            Self::Update => return own("hpf.Update"),
            Self::Axes => return ros2::schema(ros2::JOINT_STATE),
            Self::ToolPose | Self::ReferencePose => PoseInFrame::get_schema(),
            Self::Transforms => FrameTransforms::get_schema(),
            Self::ReferencePath | Self::LearnedPath => PosesInFrame::get_schema(),
            Self::Scene => SceneUpdate::get_schema(),
            Self::Log => Log::get_schema(),
        };
        foxglove.expect("foxglove's own messages have schemas")
    }
}
