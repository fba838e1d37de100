//! Angles that jump over the end of their turn.

use core::f64::consts::{PI, TAU};

use hpf_sim::Demonstration;
use hpf_sim::task::Unit;

use super::range;
use crate::collect::Raw;

/// An angle that stays within one turn, but for rounding, may be a wrapped one.
const ONE_TURN: f64 = 1.001 * TAU;

/// Takes jumps beyond half a turn as steps over the end of the turn.
pub fn unwrap(raw: &mut Raw, notes: &mut Vec<String>) {
    for axis in raw.axes.iter_mut().filter(|axis| axis.unit == Unit::Rad) {
        let is_wrapped = range(&axis.position) <= ONE_TURN;
        let jumps = axis.position.windows(2).filter(|pair| (pair[1] - pair[0]).abs() > PI).count();
        if !is_wrapped || jumps == 0 {
            continue;
        }
        let at = axis.position.windows(2).position(|pair| (pair[1] - pair[0]).abs() > PI).unwrap_or_default();
        notes.push(format!(
            "axis `{}` is an angle that jumps by a turn, {jumps} times, first in line {}: it is followed over the jump",
            axis.name,
            raw.lines[at + 1]
        ));
        for path in [Some(&mut axis.position), axis.reference.as_mut()].into_iter().flatten() {
            let mut turns = 0.0;
            for i in 1..path.len() {
                let before = path[i - 1];
                let jump = path[i] + turns - before;
                if jump.abs() > PI {
                    turns -= TAU * (jump / TAU).round();
                }
                path[i] += turns;
            }
        }
    }
}

/// Moves angles by whole turns so that all recordings of an axis start nearest to the first.
pub fn align_turns(recordings: &mut [Demonstration]) -> Vec<String> {
    let mut notes = Vec::new();
    let Some((first, others)) = recordings.split_first_mut() else { return notes };
    for (number, other) in others.iter_mut().enumerate() {
        for axis in other.axes.iter_mut().filter(|axis| axis.unit == Unit::Rad) {
            let Some(like) = first.axes.iter().find(|one| one.name == axis.name && one.unit == axis.unit) else {
                continue;
            };
            let turns = ((like.position[0] - axis.position[0]) / TAU).round();
            if turns == 0.0 || !turns.is_finite() {
                continue;
            }
            let by = turns * TAU;
            for path in [Some(&mut axis.position), axis.reference.as_mut()].into_iter().flatten() {
                path.iter_mut().for_each(|angle| *angle += by);
            }
            notes.push(format!(
                "axis `{}` of recording {} starts beyond half a turn from the first and is turned by {turns} turns, which is \
                 the same angle",
                axis.name,
                number + 2
            ));
        }
    }
    notes
}
