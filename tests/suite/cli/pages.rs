//! Pages that are made from the program: the blocks between `<!-- keys: TABLE -->`, `<!-- help: COMMAND -->` or
//! `<!-- schema: LAYOUT GROUP -->` and `<!-- end -->`. `STICTION_WRITE_PAGES=1 cargo test --release --test suite cli::pages` writes them anew.

use std::collections::BTreeMap;
use std::ops::Bound;
use std::path::Path;
use std::process::Command;
use stiction::layouts::{RUN, SWEEP};
use stiction::output::schema::{ASPERITIES, Layout, Variable};
use stiction::scene::{Absent, KEYS, Key, Scene, Sign, Value};

/// The page with its blocks as `block` has them, each by what its comment says.
fn made(page: &str, kind: &str, block: &dyn Fn(&str) -> String) -> (String, Vec<String>) {
    let (begin, end) = (format!("<!-- {kind}: "), "<!-- end -->");
    let mut pieces = page.split(&begin);
    let mut text = pieces.next().unwrap_or_default().to_owned();
    let mut names = Vec::new();
    for piece in pieces {
        let (name, rest) = piece.split_once(" -->").expect("a comment ends");
        let (_, behind) = rest.split_once(end).unwrap_or_else(|| panic!("{begin}{name} has no {end}"));
        text += &format!("{begin}{name} -->\n\n{}\n{end}{behind}", block(name));
        names.push(name.to_owned());
    }
    (text, names)
}

/// Compares a page with what it has to be, or writes it.
fn held(name: &str, kind: &str, expected: &[String], block: &dyn Fn(&str) -> String) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(name);
    let page = std::fs::read_to_string(&path).unwrap();
    let (now, names) = made(&page, kind, block);
    assert_eq!(names, expected, "the blocks of {name}");
    if std::env::var_os("STICTION_WRITE_PAGES").is_some() {
        std::fs::write(&path, now).unwrap();
        return;
    }
    let differs = page.lines().zip(now.lines()).position(|(is, should)| is != should);
    let line = differs.map_or(page.lines().count().min(now.lines().count()), |line| line);
    assert!(
        page == now,
        "docs/{name} line {}: `{}` should be `{}`; STICTION_WRITE_PAGES=1 cargo test --release --test suite cli::pages writes it",
        line + 1,
        page.lines().nth(line).unwrap_or_default(),
        now.lines().nth(line).unwrap_or_default()
    );
}

/// The table of the scene that a key is in; that of the keys in none is the scene itself.
fn table(key: &Key) -> &str {
    let is_table = matches!(key.value, Value::Table);
    key.name.split_once('.').map_or(if is_table { key.name } else { "scene" }, |(table, _)| table)
}

fn bounds(low: Bound<f64>, high: Bound<f64>) -> String {
    let number = |bound: f64| {
        if bound != 0.0 && bound.abs() < 1e-2 { format!("{bound:e}") } else { format!("{bound}") }
    };
    let text = match (low, high) {
        (Bound::Included(low), Bound::Included(high)) => {
            return format!(" from {} to {}", number(low), number(high));
        }
        (Bound::Excluded(low), Bound::Included(high)) => {
            format!(" greater than {} and at most {}", number(low), number(high))
        }
        (Bound::Excluded(low), Bound::Excluded(high)) => {
            format!(" greater than {} and less than {}", number(low), number(high))
        }
        (Bound::Excluded(low), Bound::Unbounded) => format!(" greater than {}", number(low)),
        (Bound::Unbounded, Bound::Unbounded) => String::new(),
        other => panic!("{other:?} has no words"),
    };
    text.replace('-', "−")
}

fn value(key: &Key) -> String {
    let sign = |sign: Sign| match sign {
        Sign::Any => "",
        Sign::NotNegative => ", 0 or more",
        Sign::Positive => ", greater than 0",
    };
    match &key.value {
        Value::Table => "a table".to_owned(),
        Value::Text => "a text".to_owned(),
        Value::Switch => "`true` or `false`".to_owned(),
        Value::Whole(least, most) if least == most => format!("{least}"),
        Value::Whole(least, most) => format!("a whole number from {least} to {most}"),
        Value::Number(low, high) => format!("a number{}", bounds(*low, *high)),
        Value::Quantity(dimension, of) => {
            format!("{}{}, in {}", dimension.name(), sign(*of), dimension.units())
        }
        Value::OneOrMore(dimension, of, names) => {
            let names: String = names.iter().map(|name| format!("; `\"{name}\"`")).collect();
            format!("{}{}, in {}{names}; or a list of them", dimension.name(), sign(*of), dimension.units())
        }
        Value::Choice(names) => {
            names().iter().map(|name| format!("`\"{name}\"`")).collect::<Vec<_>>().join(", ")
        }
        Value::Various(words) => (*words).to_owned(),
        Value::OfLaw(words) => words(),
    }
}

/// The keys that must not stand beside one, in either direction.
fn beside(key: &Key) -> Vec<&'static str> {
    let others = KEYS.iter().filter(|other| other.excluded.contains(&key.name)).map(|other| other.name);
    let mut names: Vec<&str> = key.excluded.iter().copied().chain(others).collect();
    names.sort_unstable();
    names.dedup();
    names
}

/// The name of a key in the reference.
fn named(key: &Key) -> String {
    key.name.replace("sweep.*", "sweep.KEY")
}

fn default(key: &Key) -> String {
    match key.absent {
        Absent::Required if beside(key).is_empty() => "required".to_owned(),
        Absent::Required => "required unless an excluded key is given".to_owned(),
        Absent::Is(value) => format!("`{value}`"),
        Absent::Follows(words) => words.to_owned(),
    }
}

/// The row of a key in the table of its section.
fn row(key: &Key) -> String {
    let anchor = named(key).replace('.', "").to_lowercase();
    let cells = [format!("[`{}`](#{anchor})", named(key)), key.what.to_owned(), default(key)];
    format!("| {} |\n", cells.map(|cell| cell.replace('|', "\\|")).join(" | "))
}

/// What the folded part of a section has of a key.
fn entry(key: &Key) -> String {
    let about = if key.about.is_empty() { String::new() } else { format!("{}\n\n", key.about) };
    let mut text = format!("#### `{}`\n\n{about}Value: {}. ", named(key), value(key));
    text += &format!("Default: {}.", default(key));
    let beside: Vec<String> = beside(key).into_iter().map(|name| format!("`{name}`")).collect();
    if !beside.is_empty() {
        text += &format!(" Excludes {}.", beside.join(", "));
    }
    if key.is_swept {
        text += " Can be swept.";
    }
    if !key.example.is_empty() {
        let last = key.name.rsplit('.').next().unwrap_or_default();
        text += &format!(" Example: `{last} = {}`", key.example);
    }
    text + "\n"
}

/// The section of a table: its keys at a glance, and folded all that there is of each.
fn section(keys: &[&Key]) -> String {
    let rows: String = keys.iter().map(|key| row(key)).collect();
    let entries: Vec<String> = keys.iter().map(|key| entry(key)).collect();
    format!(
        "| key | meaning | default |\n|---|---|---|\n{rows}\n<details markdown=\"1\">\n\
         <summary>Values, units and examples of these keys</summary>\n\n{}\n</details>\n",
        entries.join("\n")
    )
}

#[test]
fn the_scene_reference_is_what_the_table_of_keys_says() {
    let mut tables: Vec<String> = KEYS.iter().map(|key| table(key).to_owned()).collect();
    tables.dedup();
    held("scene.md", "keys", &tables, &|name| {
        let own = |key: &&Key| table(key) == name && key.name != name && !key.name.contains('[');
        section(&KEYS.iter().copied().filter(own).collect::<Vec<&Key>>())
    });
}

/// The scenes that pages show from their first line on.
#[test]
fn scenes_of_pages_are_scenes() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let mut seen = 0;
    for name in ["scene.md", "tutorial.md"] {
        let page = std::fs::read_to_string(docs.join(name)).unwrap();
        let blocks = page.split("```toml\n").skip(1).filter_map(|block| block.split("```").next());
        for scene in blocks.filter(|block| block.starts_with("format") || block.starts_with("[material]")) {
            Scene::parse(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
            seen += 1;
        }
    }
    assert_eq!(seen, 2);
    let tutorial = std::fs::read_to_string(docs.join("tutorial.md")).unwrap();
    let first = include_str!("../../../configs/first.toml");
    assert!(
        tutorial.contains(&format!("```toml\n{first}```")),
        "the scene of the tutorial is configs/first.toml"
    );
}

fn help(command: &str) -> String {
    let arguments: Vec<&str> =
        command.split(' ').filter(|word| *word != "stiction").chain(["--help"]).collect();
    let output = Command::new(env!("CARGO_BIN_EXE_stiction")).args(arguments).output().unwrap();
    assert!(output.status.success());
    String::from_utf8(output.stdout).unwrap().replace("stiction.exe", "stiction")
}

#[test]
fn the_page_of_commands_is_what_help_says() {
    let all = help("stiction");
    let listed =
        all.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names =
        listed.filter_map(|line| line.strip_prefix("  ")?.split(' ').next()).filter(|name| !name.is_empty());
    let names = names.filter(|name| *name != "help").map(|name| format!("stiction {name}"));
    let names: Vec<String> = std::iter::once("stiction".to_owned()).chain(names).collect();
    assert!(names.len() > 5, "{all}");
    held("commands.md", "help", &names, &|name| {
        let text: Vec<String> = help(name).lines().map(|line| line.trim_end().to_owned()).collect();
        format!("```text\n{}\n```\n", text.join("\n").trim_end())
    });
}

/// What the page of a layout says of a dataset.
fn dataset(layout: &Layout, variable: &Variable) -> String {
    let own = variable.dimensions.iter().map(|dimension| format!("`{}`", dimension.name()));
    let points = (layout.of_points.is_some() && !variable.is_coordinate()).then(|| "the points".to_owned());
    let dimensions: Vec<String> = points.into_iter().chain(own).collect();
    let dimensions = if dimensions.is_empty() { "none".to_owned() } else { dimensions.join(", ") };
    let listed = || format!("`{}`", variable.coordinates[0]);
    let units = variable.units.map_or_else(listed, str::to_owned);
    format!("| `{}` | {dimensions} | {units} | {} |\n", variable.name(), variable.long_name)
}

/// The page of a group: those of a run and of a sweep have one together; all else is on the page of its layout.
fn page_of(page: &str, variable: &Variable) -> String {
    match variable.group() {
        group if page == "asperity-file.md" || group.is_empty() => page.to_owned(),
        group => format!("format/{}.md", &group[1..]),
    }
}

/// A table of a page by its name, such as `run ensemble`, and the layout that it is of.
type Table = (String, &'static Layout);

/// The tables of every page.
fn tables(layouts: &[(&str, &'static Layout)]) -> BTreeMap<String, Vec<Table>> {
    let mut pages: BTreeMap<String, Vec<Table>> = BTreeMap::new();
    for (page, layout) in layouts {
        for variable in layout.variables.iter() {
            let tables = pages.entry(page_of(page, variable)).or_default();
            let name = table_of(layout, variable);
            if !tables.iter().any(|(known, _)| *known == name) {
                tables.push((name, layout));
            }
        }
    }
    pages
}

fn table_of(layout: &Layout, variable: &Variable) -> String {
    let group = variable.group().strip_prefix('/').unwrap_or("/");
    format!("{} {group}", layout.format.trim_start_matches("stiction-"))
}

#[test]
fn the_pages_of_files_are_what_the_layouts_say() {
    let layouts: [(&str, &'static Layout); 3] =
        [("format.md", &RUN), ("sweep-format.md", &SWEEP), ("asperity-file.md", &ASPERITIES)];
    for (page, tables) in tables(&layouts) {
        let names: Vec<String> = tables.iter().map(|(name, _)| name.clone()).collect();
        held(&page, "schema", &names, &|name| {
            let (_, layout) = tables.iter().find(|(known, _)| known == name).expect("a table of this page");
            let own = layout.variables.iter().filter(|variable| table_of(layout, variable) == name);
            let rows: String = own.map(|variable| dataset(layout, variable)).collect();
            format!("| dataset | dimensions | units | meaning |\n|---|---|---|---|\n{rows}")
        });
    }
    for (page, layout) in layouts {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs").join(page);
        let text = std::fs::read_to_string(path).unwrap();
        assert!(text.contains(&format!("`{}`", layout.format)), "{page}");
        assert!(text.contains(&format!("version {}.{}", layout.version[0], layout.version[1])), "{page}");
    }
}
