//! The figures of a run, or of several runs together, as PNG or SVG files: the same runs give the same bytes.
//!
//! A kind of figure is a function from runs to a [`chart::Figure`], plain data; `canvas` alone draws.

mod axis;
mod beam;
mod bitmap;
mod canvas;
mod chart;
mod contact;
mod cost;
mod demonstration;
mod distribution;
mod ends;
mod gain;
mod layout;
mod legend;
mod motions;
mod number;
mod overlay;
mod palette;
mod plane;
mod signals;
mod surface;
mod text;
mod vector;

use std::path::Path;

use hpf_sim::environment::Contact;
use hpf_sim::task::Unit;
use rayon::prelude::*;

use crate::directory::Unfinished;
use crate::failure::Failure;
use crate::files::{self, make_folder, while_writing};
use crate::results::Run;
use crate::sinks::guarded;

pub use self::chart::Figure;
pub use self::distribution::{Group, Measure, Member, cost as sweep_cost, measures as sweep_measures};
pub use self::number::short;
pub use self::overlay::{Named, figures as overlaid};
pub use self::palette::MOST_SERIES;
pub use self::surface::Format;

/// A figure that can be drawn: its name, and how it is made.
pub struct Drawing<'r> {
    /// Name of its file, without the ending.
    pub name: String,
    /// Makes it.
    pub make: Box<dyn Fn() -> Figure + Send + Sync + 'r>,
}

impl<'r> Drawing<'r> {
    /// A figure of this name.
    pub fn new(name: impl Into<String>, make: impl Fn() -> Figure + Send + Sync + 'r) -> Self {
        Self { name: name.into(), make: Box::new(make) }
    }

    /// The bytes of its file, which belongs to `subject`.
    ///
    /// # Errors
    /// [`Failure::Work`] that names the figure.
    pub fn bytes(&self, subject: &str, format: Format) -> Result<Vec<u8>, Failure> {
        let path = Path::new(&self.name);
        guarded(path, || canvas::draw((self.make)(), subject, format).map_err(while_writing(path)))
    }
}

/// The figures of `run`.
pub fn figures(run: &Run) -> Vec<Drawing<'_>> {
    let mut figures = vec![
        Drawing::new("cost", || cost::cost(run)),
        Drawing::new("stiffness", || gain::stiffness(run)),
        Drawing::new("damping", || gain::damping(run)),
    ];
    if is_disturbed(run) {
        figures.push(Drawing::new("disturbance", || signals::disturbance(run)));
    }
    match &run.task.contact {
        None if is_plane(run) => figures.push(Drawing::new("path", || plane::path(run))),
        None | Some(Contact::Wall(_)) => figures.push(Drawing::new("path", || signals::position(run))),
        Some(Contact::Cantilever(beam)) => {
            let axis = run.task.axis_index(&beam.axis).unwrap_or(0);
            figures.push(Drawing::new("beam", move || beam::curves(run, beam)));
            figures.push(Drawing::new("path", move || beam::path(run, beam, axis)));
            if run.task.axis.len() > 1 {
                figures.push(Drawing::new("position", || signals::position(run)));
            }
        }
    }
    if run.task.contact.is_some() {
        figures.push(Drawing::new("deviation", || contact::deviation(run)));
        figures.push(Drawing::new("contact_force", || contact::force(run)));
    }
    if !run.demonstrations.is_empty() {
        figures.push(Drawing::new("demonstration", || demonstration::positions(run)));
    }
    figures
}

/// Whether there are disturbances to show.
fn is_disturbed(run: &Run) -> bool {
    !run.task.disturbance.is_empty()
}

/// Whether the tool moves in a plane that can be shown as it is.
fn is_plane(run: &Run) -> bool {
    let axes = &run.task.axis;
    axes.len() == 2 && axes.iter().all(|axis| axis.unit == Unit::M)
}

/// Draws `figures` of `subject` into `folder`, and returns their file names in order.
///
/// # Errors
/// [`Failure::Work`] that names the file; a figure is under its own name whole or not at all.
pub fn draw(figures: &[Drawing<'_>], subject: &str, format: Format, folder: &Path) -> Result<Vec<String>, Failure> {
    make_folder(folder)?;
    figures.par_iter().map(|drawing| draw_one(drawing, subject, format, folder)).collect()
}

fn draw_one(drawing: &Drawing<'_>, subject: &str, format: Format, folder: &Path) -> Result<String, Failure> {
    let name = format!("{}.{}", drawing.name, format.extension());
    let path = folder.join(&name);
    guarded(&path, || {
        let bytes = canvas::draw((drawing.make)(), subject, format).map_err(while_writing(&path))?;
        files::write(&path, bytes)
    })?;
    Ok(name)
}

/// Draws the figures of `run` into `plots/` of its run directory; returns why some of them could not be drawn.
pub fn draw_into(run: &Run, folder: &mut Unfinished) -> Vec<Failure> {
    let plots = folder.path("plots");
    let drawn: Vec<_> =
        figures(run).par_iter().map(|drawing| draw_one(drawing, &run.task.name, Format::Png, &plots)).collect();
    let mut failures = Vec::new();
    for outcome in drawn {
        match outcome {
            Ok(name) => folder.written(&format!("plots/{name}")),
            Err(failure) => failures.push(failure),
        }
    }
    failures
}

#[cfg(test)]
mod tests;
