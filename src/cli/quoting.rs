//! Commands in messages, as a shell takes them.

/// A command of these words: for a POSIX shell, and on Windows for the command prompt.
pub(super) fn command(words: &[String]) -> String {
    if cfg!(windows) {
        return words.iter().map(|word| on_windows(word)).collect::<Vec<_>>().join(" ");
    }
    shlex::try_join(words.iter().map(String::as_str)).unwrap_or_default()
}

/// A word of a command line on Windows: in double quotes if it has other characters than plain names. Backslashes before a quote are
/// doubled, and a quote has a backslash before it.
fn on_windows(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_.,:/\\=+~".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    let mut quoted = String::from("\"");
    let mut backslashes = 0;
    for c in word.chars().chain(['"']) {
        if c == '"' {
            quoted.extend(std::iter::repeat_n('\\', backslashes + 1));
        }
        backslashes = if c == '\\' { backslashes + 1 } else { 0 };
        quoted.push(c);
    }
    // The last quote ends the word.
    quoted.remove(quoted.len() - 2);
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Examples of the page "Parsing C command-line arguments" of Microsoft, the other way round.
    #[test]
    fn words_on_windows_are_split_as_they_were() {
        let quoted = [
            ("scene.toml", "scene.toml"),
            ("C:\\lab\\a.toml", "C:\\lab\\a.toml"),
            ("a b", "\"a b\""),
            ("a b\\", "\"a b\\\\\""),
            ("a\\\"b", "\"a\\\\\\\"b\""),
            ("model.law=\"md\"", "\"model.law=\\\"md\\\"\""),
            ("", "\"\""),
        ];
        for (word, written) in quoted {
            assert_eq!(on_windows(word), written);
        }
    }
}
