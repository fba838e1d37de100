//! Mistakes in a task file, shown with their lines.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use hpf_sim::Diagnostic;

use crate::failure::Failure;
use crate::terminal::shown;

/// More mistakes than this are counted, not shown.
const MOST_SHOWN: usize = 20;

/// All mistakes `found` in `text`, the file `name`: place, line, what is wrong, what is allowed.
pub fn render(found: &[Diagnostic], text: &str, name: &str) -> Failure {
    let renderer = if crate::style::is_colored() { Renderer::styled() } else { Renderer::plain() };
    let name = &*shown(name);
    let mut report = String::new();
    for diagnostic in found.iter().take(MOST_SHOWN) {
        let end = diagnostic.span.end.min(text.len());
        let start = diagnostic.span.start.min(end);
        let mark = AnnotationKind::Primary.span(start..end);
        let group = Level::ERROR
            .primary_title(shown(&diagnostic.message))
            .element(Snippet::source(text).path(name).annotation(mark))
            .element(Level::HELP.message(shown(&diagnostic.help)));
        report += &renderer.render(&[group]);
        report += "\n\n";
    }
    report += &match found.len() {
        1 => format!("1 mistake in {name}"),
        count if count > MOST_SHOWN => format!("{count} mistakes in {name}, the first {MOST_SHOWN} shown"),
        count => format!("{count} mistakes in {name}"),
    };
    Failure::Report(report)
}
