//! Files that the program reads back, damaged, in processes of their own: libhdf5 may crash on a file whose
//! structure is broken, which `stiction info` and `stiction validate` survive because they read in a process
//! of their own too.

use super::bytes::damaged;
use super::cases;
use super::common::asperities::write_asperities;
use super::common::program::{Folder, small, text};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use stiction::layouts::{LAYOUTS, RUN};
use stiction::output::reader::Reader;

/// A reader of files: adding one here is all that it takes to fuzz it.
struct Target {
    name: &'static str,
    /// Writes files that it accepts into a folder, and returns their names.
    seeds: fn(&Folder) -> Vec<&'static str>,
    /// Reads one. It may refuse, but not panic.
    read: fn(&Path) -> bool,
    /// Cases of a short run.
    cases: u64,
}

const TARGETS: [Target; 2] = [
    Target { name: "result", seeds: results, read: read_result, cases: 50 },
    Target { name: "asperities", seeds: asperities, read: read_asperities, cases: 30 },
];

/// Tells a process of this test what to read: target, folder, first case, end.
const JOB: &str = "STICTION_FUZZ_JOB";
/// Names a folder for the files that kill a reader.
const KEEP: &str = "STICTION_FUZZ_KEEP";
/// Longest that a case may take.
const PATIENCE: Duration = Duration::from_secs(5);
/// Address space of a process that reads.
#[cfg(unix)]
const ADDRESS_SPACE: u64 = 1 << 30;

/// Small results, with and without curves, and a partial one.
fn results(folder: &Folder) -> Vec<&'static str> {
    let tiny = small().replace("count = 16", "count = 3").replace("replicas = 40", "replicas = 12");
    std::fs::write(folder.path("tiny.toml"), &tiny).unwrap();
    let curves = tiny
        .replace("curves = false", "curves = true")
        .replace("seed = 1", "seed = 1\nsampling = \"antithetic\"");
    std::fs::write(folder.path("curves.toml"), curves).unwrap();
    for arguments in [
        ["run", "tiny.toml", "-o", "tiny.h5"].as_slice(),
        &["run", "curves.toml", "-o", "curves.h5"],
        &["compare", "tiny.toml", "--laws", "hybrid,fit:paper", "-o", "laws.h5"],
        &["run", "curves.toml", "--shard", "1/1", "-o", "curves.shard"],
    ] {
        let output = folder.stiction(arguments);
        assert!(output.status.success(), "{output:?}");
    }
    vec!["tiny.h5", "curves.h5", "laws.h5", "curves.shard"]
}

/// Everything that can be asked of a result.
fn read_result(path: &Path) -> bool {
    let Ok(reader) = Reader::open(path, &LAYOUTS) else { return false };
    let mut whole = reader.attributes("/").is_ok();
    for group in reader.groups() {
        whole &= reader.attributes(group).is_ok();
    }
    reader.datasets();
    if let Ok(run) = Reader::open(path, &[&RUN]) {
        whole &= run.number::<u64>("/", "replicas").is_ok() && run.optional_text("/", "sampling").is_ok();
        for variable in RUN.variables.iter() {
            let _ = run.values::<f64>(&variable.path);
        }
    }
    whole
}

/// A small file of asperities.
fn asperities(folder: &Folder) -> Vec<&'static str> {
    let places: Vec<f64> = (0..30).map(|i| 1e-7 * f64::from(i)).collect();
    let heights: Vec<f64> = (0..30).map(|i| 1e-9 * f64::from(i * 7 % 30)).collect();
    write_asperities(&folder.path("out.h5"), [&places, &places, &heights, &[1e-6; 30]], [3e-6; 2]);
    vec!["out.h5"]
}

fn read_asperities(path: &Path) -> bool {
    stiction::output::asperities::read(path).is_ok()
}

fn target(name: &str) -> &'static Target {
    TARGETS.iter().find(|target| target.name == name).expect("a known target")
}

fn contents(folder: &Path, names: &[&str]) -> Vec<Vec<u8>> {
    names.iter().map(|name| std::fs::read(folder.join(name)).unwrap()).collect()
}

/// What became of the cases of a target.
#[derive(Debug, Default)]
struct Tally {
    read: u64,
    refused: u64,
    /// Cases in which the process died, and of what.
    died: Vec<(u64, String)>,
}

#[test]
fn no_damaged_file_makes_a_reader_panic() {
    let _alone = super::alone();
    for target in &TARGETS {
        let folder = Folder::new("");
        let names = (target.seeds)(&folder).join(",");
        let end = cases(target.cases);
        let mut tally = Tally::default();
        let mut first = 0;
        while first < end {
            first = stats(target, &folder, &names, first..end, &mut tally);
        }
        println!(
            "{}: {end} cases, {} read, {} refused, {} processes died: {:?}",
            target.name,
            tally.read,
            tally.refused,
            tally.died.len(),
            tally.died
        );
        assert!(tally.read > 0 && tally.refused > 0, "the cases are too hard or too easy: {tally:?}");
        // libhdf5 does not return from 0.5 % of damaged files: of n cases so many with a probability below
        // 1e-5.
        let most = 0.005 * end as f64 + 8.0 + 4.5 * (0.005 * end as f64).sqrt();
        assert!(
            (tally.died.len() as f64) <= most,
            "{} of {end} {} died: {tally:?}",
            tally.died.len(),
            target.name
        );
    }
}

/// What users see: whatever the file, the commands end with an exit code of theirs, with a line of their own
/// where they refuse, and nothing that steers the terminal.
#[test]
fn the_commands_survive_every_damaged_file() {
    let _alone = super::alone();
    let folder = Folder::new("");
    let names = results(&folder);
    let seeds = contents(&folder.path(""), &names);
    for case in 0..cases(12) {
        std::fs::write(folder.path("case.h5"), damaged(&seeds, case)).unwrap();
        let commands = [&["info"][..], &["validate"], &["info", "--json", "--all"], &["info", "--csv"]];
        for command in commands {
            let output = folder.stiction(&[command, &["case.h5"]].concat());
            let (out, error) = (text(&output.stdout), text(&output.stderr));
            match output.status.code() {
                Some(0) => assert!(error.is_empty() && !out.is_empty(), "case {case}: {error}"),
                Some(3) => {
                    assert!(error.lines().count() == 1 && command[0] == "validate", "case {case}: {error}")
                }
                Some(2) => {
                    assert!(
                        error.starts_with("stiction: case.h5: ") && error.lines().count() == 1,
                        "case {case}: {error}"
                    );
                    assert!(out.is_empty(), "case {case}: {out}");
                }
                code => panic!("case {case}: exit code {code:?}, {error}"),
            }
            assert!(!out.contains(|c: char| c.is_control() && c != '\n'), "case {case}: {out:?}");
        }
    }
}

/// Runs cases in a process of their own until it ends; returns the case to go on with.
fn stats(
    target: &Target,
    folder: &Folder,
    names: &str,
    cases: std::ops::Range<u64>,
    tally: &mut Tally,
) -> u64 {
    let job =
        format!("{}\n{}\n{}\n{}\n{names}", target.name, folder.path("").display(), cases.start, cases.end);
    let mut child = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "files::worker", "--ignored", "--nocapture"])
        .env(JOB, job)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let state = folder.path("state");
    let (mut seen, mut since) = (None, Instant::now());
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break Some(status);
        }
        let now = std::fs::read_to_string(&state).ok();
        if now != seen {
            (seen, since) = (now, Instant::now());
        } else if since.elapsed() > PATIENCE {
            child.kill().unwrap();
            child.wait().unwrap();
            break None;
        }
        std::thread::sleep(Duration::from_millis(20));
    };
    let text = std::fs::read_to_string(&state).unwrap_or_default();
    let mut numbers = text.split_whitespace().map(|number| number.parse::<u64>().unwrap());
    let (at, read, refused) = (numbers.next().unwrap(), numbers.next().unwrap(), numbers.next().unwrap());
    tally.read += read;
    tally.refused += refused;
    let mut said = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut said).unwrap();
    if let (Ok(kept), false) = (std::env::var(KEEP), status.is_some_and(|status| status.success())) {
        std::fs::copy(folder.path("case.h5"), Path::new(&kept).join(format!("{}-{at}.h5", target.name)))
            .unwrap();
    }
    match status {
        Some(status) if status.success() => return cases.end,
        Some(status) if status.code().is_some() => {
            panic!("{} case {at}: the reader panics\n{said}", target.name)
        }
        Some(status) => {
            tally.died.push((at, format!("{status}: {}", said.lines().next_back().unwrap_or_default())))
        }
        None => tally.died.push((at, "took too long".to_owned())),
    }
    at + 1
}

/// Not a test: the process that reads.
#[test]
#[ignore = "is run by no_damaged_file_makes_a_reader_panic"]
fn worker() {
    let Ok(job) = std::env::var(JOB) else { return };
    #[cfg(unix)]
    limit_memory();
    let fields: Vec<&str> = job.lines().collect();
    let target = target(fields[0]);
    let folder = PathBuf::from(fields[1]);
    let (first, end): (u64, u64) = (fields[2].parse().unwrap(), fields[3].parse().unwrap());
    let seeds = contents(&folder, &fields[4].split(',').collect::<Vec<_>>());
    let (state, file) = (folder.join("state"), folder.join("case.h5"));
    let (mut read, mut refused) = (0_u64, 0_u64);
    for case in first..end {
        std::fs::write(&state, format!("{case} {read} {refused}")).unwrap();
        std::fs::write(&file, damaged(&seeds, case)).unwrap();
        if (target.read)(&file) { read += 1 } else { refused += 1 }
    }
    std::fs::write(&state, format!("{end} {read} {refused}")).unwrap();
}

#[cfg(unix)]
fn limit_memory() {
    use rustix::process::{Resource, Rlimit, setrlimit};
    setrlimit(Resource::As, Rlimit { current: Some(ADDRESS_SPACE), maximum: Some(ADDRESS_SPACE) }).unwrap();
}
