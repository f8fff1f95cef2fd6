//! The additions that CONTRIBUTING.md shows as diffs: each touches as few files as it says, and still applies.
//! `scripts/mutations.py` builds them and runs the tests that they are for.

use std::collections::BTreeSet;
use std::path::Path;

/// The files that a diff touches, and its hunks: a file, and the lines that it has before the change.
fn parts(diff: &str) -> (BTreeSet<&str>, Vec<(&str, Vec<&str>)>) {
    let (mut files, mut hunks) = (BTreeSet::new(), Vec::new());
    let mut file = "";
    for line in diff.lines() {
        if let Some(path) = line.strip_prefix("+++ b/") {
            file = path;
            files.insert(path);
        } else if line.starts_with("@@") {
            hunks.push((file, Vec::new()));
        } else if let (Some(before), Some((_, lines))) = (line.strip_prefix([' ', '-']), hunks.last_mut())
            && !line.starts_with("--- ")
        {
            lines.push(before);
        }
    }
    (files, hunks)
}

#[test]
fn additions_touch_few_files_and_apply() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("CONTRIBUTING.md")).unwrap();
    let mut counts = Vec::new();
    for (heading, rest) in page.split("\n### ").skip(1).filter_map(|section| section.split_once('\n')) {
        let Some((_, diff)) = rest.split_once("```diff\n") else { continue };
        let (files, hunks) = parts(diff.split("\n```").next().unwrap());
        for (file, before) in hunks.iter().filter(|(_, before)| !before.is_empty()) {
            let text = std::fs::read_to_string(root.join(file)).unwrap();
            let lines: Vec<&str> = text.lines().collect();
            let is_there = lines.windows(before.len()).any(|window| window == before.as_slice());
            assert!(is_there, "{heading}: {file} has no longer\n{}", before.join("\n"));
        }
        counts.push((heading.to_owned(), files.len()));
    }
    // The file of a law or a force, and the list of all of them; a row.
    let expected = [
        ("A law", 2),
        ("A dataset", 1),
        ("A key", 1),
        ("A key with an echo", 1),
        ("A height law", 2),
        ("A force between the mean planes", 2),
    ];
    assert_eq!(counts, expected.map(|(heading, files)| (heading.to_owned(), files)));
}
