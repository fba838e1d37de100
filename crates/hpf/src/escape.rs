//! Text of any source as a terminal may show it.
//!
//! Names and messages come from policies, logs, tables, processes and arguments, and a terminal obeys what is in them:
//! colours, titles, even keys. Control characters, and the signs that turn the direction of text, are shown as `\u001b`,
//! which is also how JSON writes them. Line breaks and tabs stay; in a name they are shown too ([`line`]).

use std::borrow::Cow;

/// Whether a terminal obeys this sign instead of showing it.
fn is_obeyed(sign: char) -> bool {
    let turns_direction =
        matches!(sign, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    sign.is_control() || turns_direction || matches!(sign, '\u{2028}' | '\u{2029}')
}

fn escaped(text: &str, is_kept: impl Fn(char) -> bool) -> Cow<'_, str> {
    let is_shown = |sign: char| !is_obeyed(sign) || is_kept(sign);
    if text.chars().all(is_shown) {
        return Cow::Borrowed(text);
    }
    let show = |sign: char| if is_shown(sign) { sign.to_string() } else { format!("\\u{:04x}", u32::from(sign)) };
    Cow::Owned(text.chars().map(show).collect())
}

/// Text of several lines as a terminal may show it.
pub fn shown(text: &str) -> Cow<'_, str> {
    escaped(text, |sign| matches!(sign, '\n' | '\t'))
}

/// A name or a value as a part of a line: its line breaks are shown as well, so that it cannot pass for another line.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, |_| false)
}

/// A report that has colours of its own, made of text that is already [`shown`].
pub fn styled(text: &str) -> Cow<'_, str> {
    escaped(text, |sign| matches!(sign, '\n' | '\t' | '\u{1b}'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_shown_and_the_rest_is_left_alone() {
        assert_eq!(shown("\u{1b}]0;title\u{7}\u{1b}[2J"), "\\u001b]0;title\\u0007\\u001b[2J");
        assert_eq!(shown("\u{9b}31m\u{7f}\r"), "\\u009b31m\\u007f\\u000d");
        assert_eq!(shown("a\u{202e}b"), "a\\u202eb");
        let plain = "µ − 10⁻³ Ω\n\tq1 日本";
        assert!(matches!(shown(plain), Cow::Borrowed(text) if text == plain));
        assert_eq!(line("a\nerror: b"), "a\\u000aerror: b");
        assert_eq!(styled("\u{1b}[1mbold\u{9d}"), "\u{1b}[1mbold\\u009d");
    }

    #[test]
    fn json_stays_the_same_json() {
        let value = serde_json::json!({ "name": "\u{1b}\u{7f}\u{9b}\u{202e}\n" });
        let text = format!("{value:#}");
        let shown = shown(&text);
        assert!(!shown.chars().any(|sign| is_obeyed(sign) && sign != '\n'));
        assert_eq!(serde_json::from_str::<serde_json::Value>(&shown).unwrap(), value);
    }
}
