//! The tool that hangs on the sensor, in the loop through it.

use super::{Compliance, Controller};
use crate::passivity::safe_tool_mass;
use crate::{Law, Real};

impl<T: Real + PartialOrd, S: AsRef<[T]>, const D: usize> Controller<T, S, D> {
    /// Of each axis, whether the tool mass of the settings may oscillate in free air, in a loop of steps of `dt` [s]: it is
    /// above [`safe_tool_mass`] at the least damping that the skill allows. Rigid axes are never meant.
    ///
    /// The rule holds for every delay of the force and lag of the robot, which are not known here;
    /// [`ForceLoop`](crate::passivity::ForceLoop) decides where they are. What helps: a force filter, a law of second order
    /// whose mass is that of the tool or more, more damping.
    pub fn heavy_tool(&self, dt: T) -> [bool; D] {
        let conditioning = &self.settings.conditioning;
        let settled = conditioning.settled(dt);
        let mut heavy = [false; D];
        for ((heavy, settings), primitives) in heavy.iter_mut().zip(&self.settings.axes).zip(self.skill.axes()) {
            let mass = match primitives.law {
                Law::FirstOrder => None,
                Law::SecondOrder { mass, .. } => Some(mass),
            };
            // Between the ends of stiffness the safe mass lies between those at the ends.
            let [stiffness, least] = [&primitives.stiffness, &primitives.damping];
            *heavy = settings.compliance != Compliance::Rigid
                && [stiffness.min(), stiffness.max()].into_iter().any(|stiffness| {
                    let damping = primitives.law.damping(stiffness, least.min());
                    conditioning.tool_mass > safe_tool_mass(mass, stiffness, damping, settled, dt)
                });
        }
        heavy
    }
}
