//! Rows as the terminal shows them.

/// A labelled line; a continuation where the label is empty.
pub(super) fn row(label: &str, text: &str) -> String {
    format!("  {label:<18}{text}\n")
}

/// Characters of a line of a paragraph: those of a terminal of 80 columns less the labels.
const LINE: usize = 60;

/// A text as unlabelled lines, broken between words.
pub(super) fn paragraph(text: &str) -> String {
    labelled("", text)
}

/// A text as lines of which the first is labelled, broken between words.
pub(super) fn labelled(label: &str, text: &str) -> String {
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
    let label = |i: usize| if i == 0 { label } else { "" };
    lines.iter().enumerate().map(|(i, line)| row(label(i), line)).collect()
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
