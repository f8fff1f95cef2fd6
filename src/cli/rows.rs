//! Rows as the terminal shows them.

/// A labelled line; a continuation where the label is empty.
pub(super) fn row(label: &str, text: &str) -> String {
    format!("  {label:<18}{text}\n")
}

/// Characters of a line of a paragraph, that of a terminal less the labels.
const LINE: usize = 88;

/// A text as unlabelled lines, broken between words.
pub(super) fn paragraph(text: &str) -> String {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(word),
            Some(line) if line.chars().count() + 1 + word.chars().count() <= LINE => {
                *line += &format!(" {word}")
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| row("", line)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paragraphs_are_broken_between_words() {
        let text = "word ".repeat(40);
        let lines: Vec<String> = paragraph(&text).lines().map(|line| line.trim().to_owned()).collect();
        assert_eq!(lines.iter().map(String::len).collect::<Vec<_>>(), [84, 84, 29]);
        assert_eq!(lines.join(" "), text.trim());
    }
}
