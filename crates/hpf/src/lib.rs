#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod answers;
pub mod checkpoint;
pub mod conduct;
pub mod directory;
pub mod escape;
pub mod export;
pub mod failure;
#[cfg(feature = "figures")]
pub mod figure;
pub mod files;
pub mod job;
pub mod learning;
#[cfg(feature = "logs")]
pub mod log;
pub mod nodes;
pub mod outside;
pub mod overrides;
pub mod packed;
pub mod page;
pub mod paper;
pub mod process;
pub mod readers;
pub mod recordings;
pub mod report;
pub mod results;
pub mod save;
pub mod sinks;
pub mod start;
pub mod statistics;
pub mod summary;
pub mod trial;
pub mod watch;
pub mod words;

pub use failure::Failure;
pub use files::{LoadedTask, read_policy, read_task};
pub use job::{Finished, Job};
pub use results::{LearningRow, Run};
pub use summary::Summary;
pub use trial::{Prepared, Trial};
pub use watch::{Nobody, Watch};
