//! Texts of unknown origin as messages and tables show them: nothing in them steers the terminal.

/// Most characters of a text that a message repeats.
const MOST: usize = 60;

/// A text whose control characters, except for line ends and tabs, and invisible or reordering characters
/// stand as escapes: `\u{1b}`.
pub fn printable(text: &str) -> String {
    escaped(text, |c| c != '\n' && c != '\t' && steers(c))
}

/// A text on one line: as [`printable`], with line ends and tabs escaped too.
pub fn one_line(text: &str) -> String {
    escaped(text, steers)
}

/// The beginning of a text on one line, as messages repeat it.
pub fn shortened(text: &str) -> String {
    cut(text, MOST)
}

/// The first characters of a text on one line.
pub fn cut(text: &str, most: usize) -> String {
    let beginning: String = text.chars().take(most).collect();
    let end = if beginning.len() < text.len() { "..." } else { "" };
    one_line(&beginning) + end
}

/// Whether a character moves the cursor, hides, or changes the direction of what follows: control characters,
/// line and paragraph separators, zero-width characters, directional marks and tags.
fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

fn escaped(text: &str, escape: impl Fn(char) -> bool) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if escape(c) { shown.extend(c.escape_unicode()) } else { shown.push(c) }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_escaped() {
        assert_eq!(printable("a\u{1b}[2Jb\r\n\tc"), "a\\u{1b}[2Jb\\u{d}\n\tc");
        assert_eq!(printable("\u{9b}31m \u{7f}"), "\\u{9b}31m \\u{7f}");
        assert_eq!(printable("µm Å ² 日本"), "µm Å ² 日本");
        assert_eq!(one_line("a\nb\tc"), "a\\u{a}b\\u{9}c");
        assert_eq!(one_line("\u{202e}txt.\u{2066}"), "\\u{202e}txt.\\u{2066}");
    }

    #[test]
    fn long_texts_are_cut_between_characters() {
        assert_eq!(shortened(&"µ".repeat(60)), "µ".repeat(60));
        assert_eq!(shortened(&"µ".repeat(61)), "µ".repeat(60) + "...");
    }
}
