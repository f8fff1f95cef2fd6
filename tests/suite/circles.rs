//! No file of `src` imports another that imports it in turn, directly or by way of others.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The text of each module, such as `::engine::job`, without its tests and comments.
fn modules(folder: &Path, parent: &str, all: &mut BTreeMap<String, String>) {
    for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        let stem = path.file_stem().unwrap().to_str().unwrap();
        let is_parent = ["mod", "lib", "main"].contains(&stem);
        let name = if is_parent { parent.to_owned() } else { format!("{parent}::{stem}") };
        if path.is_dir() {
            modules(&path, &name, all);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap().lines();
            let code: Vec<&str> = code.map(|line| line.split("//").next().unwrap()).collect();
            all.entry(name).or_default().push_str(&code.join(" "));
        }
    }
}

/// The paths of an import: one for each name in its braces.
fn paths(import: &str) -> Vec<String> {
    let Some((head, rest)) = import.split_once("::{") else { return vec![import.trim().to_owned()] };
    let (mut depth, mut parts) = (0, vec![String::new()]);
    for c in rest.chars().take_while(|c| *c != ';') {
        depth += i32::from(c == '{') - i32::from(c == '}');
        match c {
            _ if depth < 0 => break,
            ',' if depth == 0 => parts.push(String::new()),
            _ => parts.last_mut().unwrap().push(c),
        }
    }
    parts.iter().flat_map(|part| paths(&format!("{}::{}", head.trim(), part.trim()))).collect()
}

/// The module that a path leads to from another, by way of re-exports too.
fn target(from: &str, path: &str, exports: &BTreeMap<String, Vec<String>>) -> Option<String> {
    let mut at = from.to_owned();
    for (i, name) in path.split("::").map(|name| name.split(' ').next().unwrap()).enumerate() {
        let child = format!("{at}::{name}");
        match name {
            "crate" => at.clear(),
            "super" => at.truncate(at.rfind("::")?),
            "self" => (),
            _ if exports.contains_key(&child) => at = child,
            _ if i == 0 => return None,
            _ => {
                let export = exports[&at].iter().find(|export| export.ends_with(&format!("::{name}")));
                return export.and_then(|export| target(&at, export, exports)).or(Some(at));
            }
        }
    }
    Some(at)
}

#[test]
fn no_files_import_each_other() {
    let (mut texts, mut exports, mut imports) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    modules(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut texts);
    for (name, text) in &texts {
        let statements = text.split(';').filter_map(|statement| statement.rsplit_once("use "));
        let is_export = |before: &str| before.rsplit(' ').nth(1).is_some_and(|word| word.starts_with("pub"));
        let (public, own): (Vec<_>, Vec<_>) = statements.partition(|(before, _)| is_export(before));
        let all = |of: &[(&str, &str)]| of.iter().flat_map(|(_, import)| paths(import)).collect::<Vec<_>>();
        let words = text.split(|c: char| !(c.is_alphanumeric() || "_:".contains(c)));
        let is_path = |word: &&str| word.starts_with("crate::") || word.starts_with("super::");
        let in_code = words.filter(|word| is_path(word) && !word.ends_with("::"));
        exports.insert(name.clone(), all(&public));
        imports.insert(
            name.clone(),
            all(&own).into_iter().chain(in_code.map(str::to_owned)).collect::<Vec<_>>(),
        );
    }
    let next = |name: &String| -> BTreeSet<String> {
        let targets = imports[name].iter().filter_map(|path| target(name, path, &exports));
        targets.filter(|other| other != name).collect()
    };
    let edges: BTreeMap<&String, BTreeSet<String>> = imports.keys().map(|name| (name, next(name))).collect();
    let is_in_circle = |name: &String| {
        let (mut open, mut seen) = (vec![name], BTreeSet::new());
        while let Some(other) = open.pop() {
            open.extend(edges[other].iter().filter(|next| seen.insert(*next)));
        }
        seen.contains(name)
    };
    let circles: Vec<_> = edges.keys().filter(|name| is_in_circle(name)).collect();
    assert!(circles.is_empty(), "files that import each other: {circles:#?}");
}
