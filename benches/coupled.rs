//! Time and memory of coupled replicas, by the program as its user runs it: `cargo bench --bench coupled`, with
//! `-- large` for 1e6 asperities, too. One replica of the cases of Shi and Polycarpou on one core, and squares of
//! case II of more asperities on two.

mod common;

use common::text;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Separations of larger squares.
const SEPARATIONS: &str = "h_star = { from = 1.5, to = 6.4, count = 50 }";

struct Row {
    case: &'static str,
    coupling: &'static str,
    /// Nominal area, µm², unless that of the case.
    area: Option<f64>,
    threads: u32,
}

fn main() {
    let is_large = std::env::args().any(|argument| argument == "large");
    let mut rows = Vec::new();
    // Case III as a repeated square has no stable state at most separations, and looks for them for long.
    for (coupling, cases) in
        [("periodic", &["case_i", "case_ii"][..]), ("patch", &["case_i", "case_ii", "case_iii"])]
    {
        rows.extend(cases.iter().map(|case| Row { case, coupling, area: None, threads: 1 }));
    }
    let areas = [1353.2, 13_532.0, 135_320.0];
    for area in areas.into_iter().take(if is_large { 3 } else { 2 }) {
        for coupling in ["periodic", "patch"] {
            rows.push(Row { case: "case_ii", coupling, area: Some(area), threads: 2 });
        }
    }
    println!("case      coupling  area, um2  cores  time, s  memory, MB  states not found to be stable");
    rows.iter().for_each(measure);
}

/// Runs a scene and prints how long it took.
fn measure(row: &Row) {
    let folder = std::env::temp_dir().join(format!("stiction-coupled-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let (scene, output) = (folder.join("scene.toml"), folder.join("run.h5"));
    std::fs::write(&scene, scene_of(row)).expect("a scene");
    let begin = Instant::now();
    let mut child = Command::new(env!("CARGO_BIN_EXE_stiction"))
        .args(["run", "--force", "--threads", &row.threads.to_string(), "-o"])
        .args([&output, &scene])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program");
    let status = format!("/proc/{}/status", child.id());
    let mut memory = f64::NAN;
    while child.try_wait().expect("a child").is_none() {
        memory = peak(&status).unwrap_or(memory);
        std::thread::sleep(Duration::from_millis(20));
    }
    let seconds = begin.elapsed().as_secs_f64();
    let said = child.wait_with_output().expect("its output");
    assert!(said.status.success(), "{}", row.case);
    let said = String::from_utf8_lossy(&said.stdout);
    let unsettled = said.lines().find(|line| line.contains("not found to be stable")).unwrap_or("0").trim();
    let area = row.area.map_or("1000".to_owned(), |area| area.to_string());
    println!(
        "{:9} {:9} {area:9}  {:5}  {seconds:7.2}  {memory:10.0}  {unsettled}",
        row.case, row.coupling, row.threads
    );
    std::fs::remove_dir_all(&folder).expect("the folder");
}

/// The scene of a row: one replica of a case.
fn scene_of(row: &Row) -> String {
    let lines = text(row.case);
    let changed = lines.lines().map(|line| {
        let key = line.split('=').next().unwrap_or_default().trim();
        match (key, row.area) {
            ("replicas", _) => "replicas = 1".to_owned(),
            ("nominal_area", Some(area)) => format!("nominal_area = \"{area} um^2\""),
            ("h_star", Some(_)) => SEPARATIONS.to_owned(),
            _ => line.to_owned(),
        }
    });
    let scene: Vec<String> = changed.collect();
    format!("{}\n[substrate]\ncoupling = \"{}\"\n", scene.join("\n"), row.coupling)
}

/// The most memory that a process has had, MB.
fn peak(status: &str) -> Option<f64> {
    let status = std::fs::read_to_string(status).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kilobytes| kilobytes / 1024.0)
}
