//! What of a task can be drawn and moved, for programs that show it.

use serde_json::{Value, json};

use super::{Gain, Task};
use crate::environment::Contact;

impl Task {
    /// An object of plain values: `name`, `duration` [s], `rate` [Hz], `axes` (name, unit, start, goal, bounds of stiffness
    /// and damping), `via` (time, position), `contact` (kind, axis, position of the surface at the start, stiffness,
    /// direction, force, whether the position is a key of the task), `forces` (kind, axis, amplitude where it is one fixed
    /// number), `method`, `seed` and `random`, whether something is drawn.
    pub fn outline(&self) -> Value {
        let task = self;
        let axes = task.axis.iter().enumerate().map(|(a, axis)| {
            let bounds = |gain: &Gain| [gain.min.of(a), gain.max.of(a)];
            json!({
                "name": axis.name, "unit": axis.unit.symbol(), "start": axis.start, "goal": axis.goal,
                "stiffness": bounds(&task.stiffness), "damping": bounds(&task.damping),
            })
        });
        let via = task.via_point.iter().map(|via| json!({ "time": via.time, "position": via.position }));
        let contact = task.contact.as_ref().map(|contact| {
            let start = task.axis_index(contact.axis()).map_or(0.0, |axis| task.axis[axis].start);
            let surface = contact.surface(0.0, start);
            json!({
                "kind": contact.kind(), "axis": contact.axis(), "position": surface.position,
                "stiffness": surface.stiffness, "direction": surface.direction, "force": surface.set_point,
                "movable": matches!(contact, Contact::Wall(_)),
            })
        });
        let forces = task.disturbance.iter().map(|disturbance| {
            let numbers = disturbance.quantities();
            let amplitude = numbers.iter().find(|(key, _)| *key == "amplitude").filter(|(_, number)| number.is_fixed());
            json!({
                "kind": disturbance.kind(), "axis": disturbance.axis(),
                "amplitude": amplitude.map(|(_, number)| number.mean()),
            })
        });
        json!({
            "name": task.name, "duration": task.duration, "rate": task.rate, "axes": axes.collect::<Vec<_>>(),
            "via": via.collect::<Vec<_>>(), "contact": contact, "forces": forces.collect::<Vec<_>>(),
            "method": task.learning.method.name(), "seed": task.learning.seed, "random": task.is_random(),
        })
    }
}
