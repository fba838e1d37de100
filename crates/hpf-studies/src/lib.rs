#![doc = include_str!("../README.md")]
#![forbid(unsafe_code)]

pub mod benchmark;
mod many;
pub mod reproduce;
pub mod sweep;

pub use self::many::StudyWatch;
