//! Rows as the terminal shows them.

/// A labelled line; a continuation where the label is empty.
pub(crate) fn row(label: &str, text: &str) -> String {
    format!("  {label:<18}{text}\n")
}

/// Columns of a terminal.
pub(crate) const COLUMNS: usize = 80;
/// Columns behind the labels.
const LINE: usize = COLUMNS - 20;

/// A text as unlabelled lines, broken between words.
pub(crate) fn paragraph(text: &str) -> String {
    labelled("", text)
}

/// A text as lines of which the first is labelled, broken between words.
pub(crate) fn labelled(label: &str, text: &str) -> String {
    let label = |i: usize| if i == 0 { label } else { "" };
    broken(text, LINE).iter().enumerate().map(|(i, line)| row(label(i), line)).collect()
}

/// A text as lines of at most `columns` columns, a number on a line with its unit; a longer word is alone.
pub(crate) fn broken(text: &str, columns: usize) -> Vec<String> {
    let mut pieces: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match pieces.last_mut() {
            Some(number) if number.parse::<f64>().is_ok() => *number += &format!(" {word}"),
            _ => pieces.push(word.to_owned()),
        }
    }
    let mut lines = vec![String::new()];
    for piece in pieces {
        match lines.last_mut() {
            Some(line) if line.is_empty() => *line = piece,
            Some(line) if line.chars().count() + 1 + piece.chars().count() <= columns => {
                *line += &format!(" {piece}")
            }
            _ => lines.push(piece),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_broken_between_words() {
        let text = "word ".repeat(40);
        let lines: Vec<String> = paragraph(&text).lines().map(|line| line.trim().to_owned()).collect();
        assert_eq!(lines.iter().map(String::len).collect::<Vec<_>>(), [59, 59, 59, 19]);
        assert_eq!(lines.join(" "), text.trim());
    }
}
