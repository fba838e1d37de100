//! Mistakes in a file that people write, shown with their lines.

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};
use hpf_sim::Mistakes;

use crate::escape::shown;

/// More mistakes than this are counted, not shown.
const MOST_SHOWN: usize = 20;

/// The mistakes of a file.
#[derive(Debug)]
pub struct Report {
    /// All of them.
    pub mistakes: Mistakes,
    /// The name of the file.
    pub name: String,
    /// Further lines of the report.
    pub lines: Vec<String>,
}

impl Report {
    /// All of them: place, line, what is wrong, what is allowed. All text in it is [`shown`].
    pub fn render(&self, is_colored: bool) -> String {
        let renderer = if is_colored { Renderer::styled() } else { Renderer::plain() };
        let (text, name) = (self.mistakes.text(), &*shown(&self.name));
        let mut report = String::new();
        for diagnostic in self.mistakes.iter().take(MOST_SHOWN) {
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
        report += &match self.mistakes.len() {
            1 => format!("1 mistake in {name}"),
            count if count > MOST_SHOWN => format!("{count} mistakes in {name}, the first {MOST_SHOWN} shown"),
            count => format!("{count} mistakes in {name}"),
        };
        for line in &self.lines {
            report.push('\n');
            report += &shown(line);
        }
        report
    }
}
