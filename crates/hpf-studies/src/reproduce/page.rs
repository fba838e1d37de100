//! Claims and decisions as Markdown and JSON, and as part of a page between two marks.

use serde_json::{Value, json};

use super::claims::Claim;
use super::decisions::decisions;
use super::study::Study;
use super::words::worst;

const BEGIN: &str = "<!-- begin: hpf reproduce -->";
const END: &str = "<!-- end: hpf reproduce -->";

/// The whole as Markdown.
pub fn markdown(study: &Study, claims: &[Claim], variants: &[Claim]) -> String {
    let seeds = match study.seeds.as_slice() {
        [one] => format!("seed {one}"),
        [first, .., last] => format!("{} seeds, {first} to {last}", study.seeds.len()),
        [] => String::new(),
    };
    let ours = format!("ours: median and worst of {seeds}");
    let mut text = table(
        &["the paper", "claim", &ours, "holds?"],
        claims.iter().map(|claim| {
            let verdict = if claim.holds == Some(true) { "yes" } else { "**no**" };
            let because = if claim.because.is_empty() { String::new() } else { format!("; {}", claim.because) };
            vec![claim.place.to_owned(), claim.says.to_owned(), claim.ours.clone(), format!("{verdict}{because}")]
        }),
    );
    text += "\nWhat comes out where something is done otherwise, over the same seeds:\n\n";
    text += &table(
        &["task", "how", "median and worst", "what it says"],
        variants.iter().map(|variant| {
            vec![variant.place.to_owned(), variant.says.to_owned(), variant.ours.clone(), variant.because.to_owned()]
        }),
    );
    text += "\nWhere the paper is silent or inconsistent, and what was decided:\n\n";
    text += &table(
        &["subject", "the paper", "HPF"],
        decisions(study.beam())
            .into_iter()
            .map(|decision| vec![decision.subject.to_owned(), decision.paper, decision.ours]),
    );
    text
}

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rules = format!("|{}\n", "---|".repeat(header.len()));
    let header: Vec<String> = header.iter().map(|cell| (*cell).to_owned()).collect();
    line(&header) + &rules + &rows.map(|cells| line(&cells)).collect::<String>()
}

/// The whole for other programs.
pub fn json(study: &Study, claims: &[Claim], variants: &[Claim]) -> Value {
    let claim = |claim: &Claim| {
        let numbers = claim.numbers.iter().map(|number| {
            json!({
                "name": number.name,
                "unit": number.unit,
                "median": number.spread.median,
                "worst": worst(number.spread, number.worst),
                "over_seeds": number.spread.to_json(),
            })
        });
        json!({
            "place": claim.place,
            "says": claim.says,
            "ours": claim.ours,
            "holds": claim.holds,
            "because": claim.because,
            "numbers": numbers.collect::<Vec<_>>(),
        })
    };
    let decision = |decision: super::decisions::Decision| json!({ "subject": decision.subject, "paper": decision.paper, "hpf": decision.ours });
    json!({
        "format": "hpf-reproduction",
        "version": 1,
        "seeds": study.seeds,
        "claims": claims.iter().map(claim).collect::<Vec<_>>(),
        "variants": variants.iter().map(claim).collect::<Vec<_>>(),
        "decisions": decisions(study.beam()).into_iter().map(decision).collect::<Vec<_>>(),
    })
}

/// `page` with `block` between its marks.
///
/// # Errors
/// What is wrong with the marks.
pub fn placed(page: &str, block: &str) -> Result<String, String> {
    let missing = || format!("the page needs a line `{BEGIN}` and, later, a line `{END}`");
    let begin = page.find(BEGIN).ok_or_else(missing)? + BEGIN.len();
    let end = begin + page[begin..].find(END).ok_or_else(missing)?;
    Ok(format!("{}\n\n{block}\n{}", &page[..begin], &page[end..]))
}

/// The first line in which `page` differs from `wanted`, if there is one: number, line, what it should be.
pub fn difference(page: &str, wanted: &str) -> Option<(usize, String, String)> {
    let (mut is, mut should) = (page.lines(), wanted.lines());
    for number in 1.. {
        match (is.next(), should.next()) {
            (None, None) => break,
            (a, b) if a == b => {}
            (a, b) => return Some((number, a.unwrap_or("(end)").to_owned(), b.unwrap_or("(end)").to_owned())),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_between_the_marks_is_replaced_and_nothing_else() {
        let page = format!("before\n{BEGIN}\nold\n{END}\nafter\n");
        let placed_once = placed(&page, "new\n").unwrap();
        assert_eq!(placed_once, format!("before\n{BEGIN}\n\nnew\n\n{END}\nafter\n"));
        assert_eq!(placed(&placed_once, "new\n").unwrap(), placed_once);
        assert!(placed("no marks", "new").is_err());
    }

    #[test]
    fn the_first_line_that_differs_is_named() {
        assert_eq!(difference("a\nb\n", "a\nb\n"), None);
        assert_eq!(difference("a\nb", "a\nc"), Some((2, "b".into(), "c".into())));
        assert_eq!(difference("a", "a\nc"), Some((2, "(end)".into(), "c".into())));
    }
}
