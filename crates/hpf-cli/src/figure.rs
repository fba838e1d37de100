//! The figures of a run, as PNG files: the same run gives the same bytes.
//!
//! A kind of figure is a function from a run to a [`chart::Figure`], plain data; [`canvas`] alone draws.

mod axis;
mod beam;
mod canvas;
mod chart;
mod contact;
mod cost;
mod demonstration;
mod gain;
mod layout;
mod legend;
mod motions;
mod number;
mod palette;
mod plane;
mod signals;
mod surface;
mod text;

use std::fs;
use std::path::Path;

use hpf_sim::environment::Contact;
use hpf_sim::task::Unit;
use rayon::prelude::*;

use crate::directory::Unfinished;
use crate::failure::Failure;
use crate::files::while_writing;
use crate::results::Run;

/// Makes a figure of a run.
type Kind<'r> = Box<dyn Fn() -> chart::Figure + Send + Sync + 'r>;

/// The figures of `run`: file name, and how each is made.
fn figures(run: &Run) -> Vec<(&'static str, Kind<'_>)> {
    let mut figures: Vec<(&'static str, Kind<'_>)> = vec![
        ("cost.png", Box::new(|| cost::cost(run))),
        ("stiffness.png", Box::new(|| gain::stiffness(run))),
        ("damping.png", Box::new(|| gain::damping(run))),
    ];
    let axes = &run.task.axis;
    if run.task.contact.is_none() || !run.task.disturbance.is_empty() {
        figures.push(("disturbance.png", Box::new(|| signals::disturbance(run))));
    }
    match &run.task.contact {
        None => {
            if axes.len() == 2 && axes.iter().all(|axis| axis.unit == Unit::M) {
                figures.push(("path.png", Box::new(|| plane::path(run))));
            } else {
                figures.push(("path.png", Box::new(|| signals::position(run))));
            }
        }
        Some(contact) => {
            match contact {
                Contact::Cantilever(beam) => {
                    let axis = run.task.axis_index(&beam.axis).unwrap_or(0);
                    figures.push(("beam.png", Box::new(move || beam::curves(run, beam))));
                    figures.push(("path.png", Box::new(move || beam::path(run, beam, axis))));
                    if axes.len() > 1 {
                        figures.push(("position.png", Box::new(|| signals::position(run))));
                    }
                }
                Contact::Wall(_) => figures.push(("path.png", Box::new(|| signals::position(run)))),
            }
            figures.push(("deviation.png", Box::new(|| contact::deviation(run))));
            figures.push(("contact_force.png", Box::new(|| contact::force(run))));
        }
    }
    figures
}

/// File names of the figures of `run`, in their order.
pub fn names(run: &Run) -> Vec<&'static str> {
    figures(run).into_iter().map(|(name, _)| name).collect()
}

/// Draws the figures of `run` into `folder`, and returns their file names in order.
///
/// # Errors
/// [`Failure::Work`] that names the file; a figure is under its own name whole or not at all.
pub fn draw(run: &Run, folder: &Path) -> Result<Vec<String>, Failure> {
    draw_all(figures(run), &run.task.name, folder)
}

fn draw_all(figures: Vec<(&str, Kind<'_>)>, subject: &str, folder: &Path) -> Result<Vec<String>, Failure> {
    fs::create_dir_all(folder).map_err(while_writing(folder))?;
    let draw = |(name, figure): (&str, Kind<'_>)| {
        let path = folder.join(name);
        // The encoder goes by the ending of the name, so the temporary one keeps it.
        let temporary = path.with_extension("partial.png");
        let drawn = canvas::draw(figure(), subject, &temporary).map_err(while_writing(&path));
        drawn.and_then(|()| fs::rename(&temporary, &path).map_err(while_writing(&path))).inspect_err(|_| {
            // The error to report is the first one; a leftover is removed as far as possible.
            let _ = fs::remove_file(&temporary);
        })?;
        Ok(name.to_owned())
    };
    figures.into_par_iter().map(draw).collect()
}

/// Draws the figures of `run` into `plots/` of its run directory.
///
/// # Errors
/// As [`draw`].
pub fn draw_into(run: &Run, folder: &mut Unfinished) -> Result<(), Failure> {
    for name in draw(run, &folder.path("plots"))? {
        folder.written(&format!("plots/{name}"));
    }
    Ok(())
}

/// Draws the demonstrations that the policy of `run` imitates into `plots/`, each by axis at the samples of the run.
///
/// # Errors
/// As [`draw`].
pub fn draw_demonstrations(
    run: &Run,
    demonstrations: &[Vec<Vec<f64>>],
    folder: &mut Unfinished,
) -> Result<(), Failure> {
    let figure: Kind<'_> = Box::new(|| demonstration::positions(run, demonstrations));
    for name in draw_all(vec![("demonstration.png", figure)], &run.task.name, &folder.path("plots"))? {
        folder.written(&format!("plots/{name}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
