//! A clamped beam that the tool travels along, pressing it down with a set-point force.
//!
//! | symbol | name | unit |
//! |---|---|---|
//! | l | `length` | m |
//! | b, h | `width`, `thickness` | m |
//! | E | `youngs_modulus` | Pa |
//! | F | `force`, the set-point the tool holds | N |
//! | k_c | `contact_stiffness` | N/m |
//!
//! `I = b h^3/12` (the paper swaps the symbols; read literally its tip would sink by 0.2 mm, not 32 mm).
//! Deflection under the tool at x: `tip_load` `F x^2 (3 l - x)/(6 E I)` (the paper's Eq. 25: the shape of a beam loaded
//! at its tip), `moving_load` `F x^3/(3 E I)` (a tool that presses AT x). They meet only at 0 and l.
//! Contact: compliances in series, `1/K_e = n(x)/F + 1/k_c`; at the clamp only the contact itself yields.
//! The movement starts in contact equilibrium at x = `from`: the axis starts on the surface that the force has bent there
//! by n(from), and the tool, its reference with it, has already pressed by F/k_c.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::Surface;

/// A clamped beam that the tool travels along, pressing it down.
#[derive(Clone, Debug, Deserialize, JsonSchema, PartialEq, Serialize)]
#[schemars(deny_unknown_fields)]
pub struct Cantilever {
    /// Axis along which the tool presses, positive into the beam.
    pub axis: String,
    /// The curve the beam takes.
    #[serde(default)]
    pub curve: Curve,
    /// Length of the beam [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub length: f64,
    /// Width of its section [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub width: f64,
    /// Thickness of its section [m].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub thickness: f64,
    /// Young's modulus of its material [Pa].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub youngs_modulus: f64,
    /// Force the tool is to press with [N].
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub force: f64,
    /// Stiffness of the contact itself [N/m].
    #[serde(default = "default_contact_stiffness")]
    #[schemars(extend("exclusiveMinimum" = 0))]
    pub contact_stiffness: f64,
    /// How the tool moves along the beam.
    #[serde(default)]
    pub travel: Travel,
    /// Where along the beam the tool starts, from the clamp on [m]: less than the length.
    #[serde(default)]
    #[schemars(range(min = 0))]
    pub from: f64,
}

fn default_contact_stiffness() -> f64 {
    1e6
}

/// The curve of a loaded beam.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Curve {
    /// Loaded at its tip (the paper's Eq. 25).
    #[default]
    TipLoad,
    /// Loaded where the tool is.
    MovingLoad,
}

/// How the tool moves along the beam, from its start to the tip over the duration.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Travel {
    /// From rest to rest with minimum jerk.
    #[default]
    MinimumJerk,
    /// At constant speed.
    Linear,
}

/// Minimum jerk from 0 to 1 over `progress` in [0, 1] (Flash, Hogan, J. Neurosci. 5(7):1688, 1985).
pub fn minimum_jerk(progress: f64) -> f64 {
    progress * progress * progress * (10.0 - progress * (15.0 - 6.0 * progress))
}

impl Cantilever {
    /// Bending stiffness E I [N m^2].
    ///
    /// ```
    /// # let beam: hpf_sim::environment::Cantilever = serde_json::from_str(r#"{ "axis": "y", "length": 0.8,
    /// #   "width": 0.05, "thickness": 0.004, "youngs_modulus": 200e9, "force": 10.0 }"#).unwrap();
    /// assert!((beam.bending_stiffness() - 53.333).abs() < 1e-3); // the paper's steel beam
    /// assert!((beam.deflection(0.8) - 0.032).abs() < 1e-15); // its tip sinks by 32 mm
    /// ```
    pub fn bending_stiffness(&self) -> f64 {
        self.youngs_modulus * self.width * self.thickness * self.thickness * self.thickness / 12.0
    }

    /// Deflection n(x) under the tool at `x` [m] for the set-point force [m].
    pub fn deflection(&self, x: f64) -> f64 {
        self.deflection_of(self.curve, x)
    }

    /// Deflection at `x` [m] of either curve [m].
    pub fn deflection_of(&self, curve: Curve, x: f64) -> f64 {
        match curve {
            Curve::TipLoad => self.force * x * x * (3.0 * self.length - x) / (6.0 * self.bending_stiffness()),
            Curve::MovingLoad => self.force * x * x * x / (3.0 * self.bending_stiffness()),
        }
    }

    /// How far along the beam the tool is at `progress` = t/T [m]; after the end, where it ended.
    pub fn travel_at(&self, progress: f64) -> f64 {
        let progress = progress.min(1.0);
        match self.travel {
            Travel::MinimumJerk => self.from + (self.length - self.from) * minimum_jerk(progress),
            Travel::Linear => self.from + (self.length - self.from) * progress,
        }
    }

    /// The beam under the tool at `progress` = t/T; bent by the force where the tool starts, its surface is at `start` [m].
    pub fn surface(&self, progress: f64, start: f64) -> Surface {
        let deflection = self.deflection(self.travel_at(progress));
        Surface {
            direction: 1.0,
            position: start - self.deflection(self.from),
            stiffness: 1.0 / (deflection / self.force + 1.0 / self.contact_stiffness),
            deflection,
            set_point: self.force,
        }
    }

    /// Where the pressing tool rests at the beginning, its reference with it [m].
    pub fn initial_position(&self, start: f64) -> f64 {
        start + self.force / self.contact_stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn papers_beam(curve: Curve, travel: Travel) -> Cantilever {
        Cantilever {
            axis: "y".into(),
            curve,
            length: 0.8,
            width: 0.05,
            thickness: 0.004,
            youngs_modulus: 200e9,
            force: 10.0,
            contact_stiffness: 1e6,
            travel,
            from: 0.0,
        }
    }

    /// The paper's beam; deflections of both curves and the stiffness of the moving load, from the closed forms by hand.
    #[test]
    fn the_beam_bends_as_its_table_says() {
        let beam = papers_beam(Curve::TipLoad, Travel::MinimumJerk);
        let table = [
            (0.05, 0.0078e-3, 0.1836e-3, 1.28e6),
            (0.10, 0.0625e-3, 0.7188e-3, 1.60e5),
            (0.20, 0.5000e-3, 2.7500e-3, 2.00e4),
            (0.40, 4.0000e-3, 10.0000e-3, 2500.0),
            (0.80, 32.0000e-3, 32.0000e-3, 312.5),
        ];
        for (x, moving, tip, stiffness) in table {
            // The table rounds deflections to 0.1 um and stiffness to three digits.
            assert!((beam.deflection_of(Curve::MovingLoad, x) - moving).abs() <= 0.5e-7);
            assert!((beam.deflection_of(Curve::TipLoad, x) - tip).abs() <= 0.5e-7);
            let found = beam.force / beam.deflection_of(Curve::MovingLoad, x);
            assert!((found / stiffness - 1.0).abs() < 1e-9, "{found} at {x}");
        }
        let gap = |x: f64| beam.deflection_of(Curve::TipLoad, x) - beam.deflection_of(Curve::MovingLoad, x);
        assert!((gap(1.6 / 3.0) - 7.11e-3).abs() < 0.005e-3, "the curves differ most at two thirds");
    }

    #[test]
    fn the_set_point_force_gives_the_deflection_and_the_indentation() {
        let beam = papers_beam(Curve::MovingLoad, Travel::Linear);
        let surface = beam.surface(0.5, 0.1);
        let position = 0.1 + beam.deflection(0.4) + 1e-5;
        assert!((surface.contact_force(position) - 10.0).abs() < 1e-9);
        assert_eq!(surface.contact_force(0.05), 0.0, "a beam does not pull");
    }

    #[test]
    fn minimum_jerk_starts_and_ends_at_rest() {
        assert_eq!((minimum_jerk(0.0), minimum_jerk(0.5), minimum_jerk(1.0)), (0.0, 0.5, 1.0));
        assert!(minimum_jerk(1e-4) < 1e-11 && 1.0 - minimum_jerk(1.0 - 1e-4) < 1e-11);
    }
}
