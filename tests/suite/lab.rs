//! The calls of the page "Will my pad stick?", on this machine: the same results as the program's, to the bit, from pieces of any
//! size and in any order; scenes edited and refused in the program's words.

use crate::common::program::{Folder, assert_exit, looped, small, text};
use serde_json::{Value, json};
use stiction::lab::Lab;

/// A loop of softer summits, which yield: it has a model range.
fn pad() -> String {
    looped(&small()).replace("\"100 um^2\"", "\"40 um^2\"").replace("replicas = 40", "replicas = 37")
        + "\n[instability]\npreload = [\"1 uN\", \"20 uN\"]\n\n[device]\nrestoring_force = \"10 uN\"\n"
}

fn lab() -> Lab {
    Lab::new(2).unwrap()
}

fn reply(lab: &mut Lab, name: &str, argument: &Value) -> Value {
    let text = argument.as_str().map_or_else(|| argument.to_string(), str::to_owned);
    serde_json::from_slice(&lab.call(name, text.as_bytes())).unwrap()
}

fn ask(lab: &mut Lab, name: &str, argument: &Value) -> Value {
    let reply = reply(lab, name, argument);
    assert!(reply.get("error").is_none(), "{name}: {reply}");
    reply
}

fn refused(lab: &mut Lab, name: &str, argument: &Value) -> Value {
    reply(lab, name, argument)["error"].clone()
}

fn merged(lab: &mut Lab, piece: &[u8]) -> Value {
    serde_json::from_slice(&lab.call("merge", piece)).unwrap()
}

/// The text of the results of a scene, computed by two instances in pieces of a size, the last first, and merged by a third, which
/// is given too.
fn computed(scene: &str, size: u64) -> (String, Lab) {
    let mut labs = [lab(), lab(), lab()];
    for lab in &mut labs {
        ask(lab, "prepare", &json!({ "toml": scene }));
    }
    let [first, second, merging] = &mut labs;
    let parts = ask(merging, "integral", &json!(""))["parts"].clone();
    for part in parts.as_array().unwrap() {
        let replicas = part["replicas"].as_u64().unwrap();
        let pieces = (0..replicas).step_by(size as usize).enumerate().map(|(i, from)| {
            let mut asked = part.clone();
            asked["first"] = json!(from);
            asked["count"] = json!(size.min(replicas - from));
            let by = if i % 2 == 0 { &mut *first } else { &mut *second };
            by.call("compute", asked.to_string().as_bytes())
        });
        for piece in pieces.collect::<Vec<Vec<u8>>>().iter().rev() {
            let merged = merged(merging, piece);
            assert!(merged.get("error").is_none(), "{merged}");
        }
    }
    let text = String::from_utf8(merging.call("results", b"")).unwrap();
    let [.., merging] = labs;
    (text, merging)
}

/// Whether a reply has these numbers under a name, to the bit: texts are compared, since `serde_json` reads numbers to a digit less
/// than it writes.
#[track_caller]
fn assert_has(reply: &str, name: &str, numbers: &(impl serde::Serialize + ?Sized)) {
    let expected = format!("\"{name}\":{}", serde_json::to_string(numbers).unwrap());
    assert!(reply.contains(&expected), "{name}");
}

/// The summary, but for the lines about the file, and the numbers of every replica and of the mean curves.
#[test]
fn pieces_make_the_results_of_the_program() {
    let scene = pad();
    let folder = Folder::new(&scene);
    let output = folder.stiction(&["run", "scene.toml", "--quiet"]);
    assert_exit(&output, 0);
    let (summary, _) =
        text(&output.stdout).rsplit_once("\n  written").map(|(own, _)| (own.to_owned(), ())).unwrap();
    let parsed = stiction::Scene::parse(&scene).unwrap();
    let whole = stiction::run(&parsed).unwrap();
    for size in [8, 3] {
        let (text, mut lab) = computed(&scene, size);
        let results: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(results["summary"], summary, "{size}");
        // The curve of a probability goes through what is stated at restoring forces, where contacts differ, too.
        let above = &results["after_preload"][1]["above"];
        let mut differ = false;
        for k in (60..200).step_by(20) {
            let force = format!("{} N", above["forces"][k]);
            let at =
                ask(&mut lab, "results", &json!({ "above": force }))["after_preload"][1]["stuck"].clone();
            for (end, curve) in [("p", &above["p"]), ("low", &above["low"]), ("high", &above["high"])] {
                assert_eq!(at[end], curve[k], "{end} {k}");
            }
            for contact in ["ke", "zmc", "tn"] {
                assert_eq!(at["range"][contact], above["range"][contact][k], "{contact} {k}");
                differ |= at["range"][contact] != at["p"];
            }
        }
        assert!(differ);
        assert_eq!(results["complete"], true);
        assert_eq!(results["contacts"], json!(["jg", "ke", "zmc", "tn"]));
        let every: Vec<f64> = whole.ensemble().replicas.iter().map(|own| own.pull_off_force).collect();
        assert_has(&text, "every", &every);
        let (mean, std) = (whole.ensemble().curves[2].mean(), whole.ensemble().curves[2].std());
        let s = parsed.separations.len();
        for i in 0..2 {
            assert_has(&text, "mean", &mean[i * s..(i + 1) * s]);
            assert_has(&text, "std", &std[i * s..(i + 1) * s]);
        }
        assert_has(&text, "controlled_interval", &whole.pull_off().controlled_interval);
    }
}

/// Without a loop, with groups of replicas and with targets, whose run ends where the program's does.
#[test]
fn other_scenes_make_the_results_of_the_program() {
    let grouped = small().replace("replicas = 40", "replicas = 40\nsampling = \"stratified\"");
    let target = "\n[[ensemble.target]]\nquantity = \"pull_off_force\"\nrelative_standard_error = 0.02\n";
    let ended = small().replace("replicas = 40", "min_replicas = 32\nmax_replicas = 400") + target;
    for (scene, size) in [(grouped, 8), (ended, 5)] {
        let whole = stiction::run(&stiction::Scene::parse(&scene).unwrap()).unwrap();
        let (text, _) = computed(&scene, size);
        let results: Value = serde_json::from_str(&text).unwrap();
        assert_eq!(results["replicas"], whole.ensemble().replicas.len());
        assert_has(&text, "controlled_mean", &whole.pull_off().controlled_mean);
        assert_has(&text, "interval", &whole.pull_off().interval);
    }
}

/// Results of what there is before all is in, and at another restoring force without computing anew.
#[test]
fn results_come_on_the_way_and_at_other_forces() {
    let mut lab = lab();
    assert_eq!(refused(&mut lab, "results", &json!(""))["text"], "no scene is prepared");
    ask(&mut lab, "prepare", &json!({ "toml": small() }));
    assert_eq!(refused(&mut lab, "results", &json!(""))["text"], "no batch of replicas is merged yet");
    ask(&mut lab, "prepare", &json!({ "toml": pad(), "above": "15 uN" }));
    let piece = lab.call("compute", br#"{"first": 0, "count": 8}"#);
    let length = u32::from_le_bytes(*piece.first_chunk().unwrap()) as usize;
    let head: Value = serde_json::from_slice(&piece[4..4 + length]).unwrap();
    // Merged before the integral is known: it waits.
    assert_eq!(merged(&mut lab, &piece)["merged"], 0);
    ask(&mut lab, "integral", &json!(""));
    let again = merged(&mut lab, &piece);
    assert_eq!((&again["merged"], &again["complete"]), (&json!(8), &json!(false)));
    let results = ask(&mut lab, "results", &json!(""));
    assert_eq!((&results["replicas"], &results["complete"]), (&json!(8), &json!(false)));
    assert_eq!(results["whole"]["every"], head["pull_off"]);
    let after = |i: usize| results["after_preload"][i]["every"].as_array().unwrap().clone();
    let heads: Vec<Value> = (0..8).map(|i| json!([after(0)[i], after(1)[i]])).collect();
    assert_eq!(head["after_preload"], json!(heads));
    assert_eq!(results["after_preload"][1]["stuck"]["force"], 15e-6);
    let weaker = ask(&mut lab, "results", &json!({ "above": "1 pN" }));
    assert_eq!(weaker["after_preload"][1]["stuck"]["p"], 1.0);
    assert!(weaker["summary"].as_str().unwrap().contains("above 1.000 pN"));
    let above = &weaker["after_preload"][1]["above"];
    assert_eq!((&above["p"][0], &above["p"][200]), (&json!(1.0), &json!(0.0)));
    let refused = refused(&mut lab, "results", &json!({ "above": "1 nm" }));
    assert!(refused["text"].as_str().unwrap().starts_with("--above 1 nm: a force with a unit"), "{refused}");
}

#[test]
fn pieces_of_other_scenes_and_damaged_ones_are_refused() {
    let (mut one, mut other) = (lab(), lab());
    ask(&mut one, "prepare", &json!({ "toml": pad() }));
    ask(&mut other, "prepare", &json!({ "toml": pad().replace("10 uN", "11 uN") }));
    let piece = one.call("compute", br#"{"first": 0, "count": 1}"#);
    assert_eq!(merged(&mut other, &piece)["error"]["text"], "the piece is of another scene");
    for length in [0, 3, 20, piece.len() - 1] {
        let refused = merged(&mut one, &piece[..length]);
        assert_eq!(refused["error"]["text"], "the piece is damaged, or of another version", "{length}");
    }
    for asked in [
        r#"{"first": 37, "count": 1}"#,
        r#"{"first": 0, "count": 0}"#,
        r#"{"first": 0, "count": 18446744073709551615}"#,
    ] {
        assert_eq!(
            refused(&mut one, "compute", &json!(asked))["text"],
            "there are 37 replicas only",
            "{asked}"
        );
    }
    let unknown =
        refused(&mut one, "compute", &json!({ "contact": "xy", "replicas": 8, "first": 0, "count": 1 }));
    assert_eq!(unknown["text"], "there is no plastic contact \"xy\"");
    assert!(
        refused(&mut one, "compute", &json!("{"))["text"]
            .as_str()
            .unwrap()
            .starts_with("the call is not understood")
    );
    assert_eq!(refused(&mut one, "fly", &json!(""))["text"], "there is no call \"fly\"");
}

/// The template of the page is the README's pad with the force of its command; a key is set with its note, and a value with its unit.
#[test]
fn scenes_are_edited_and_described() {
    let mut lab = lab();
    let template = ask(&mut lab, "template", &json!("pad"));
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let own = template["toml"].as_str().unwrap();
    let (pad, device) = own.split_at(own.find("device.").unwrap());
    assert!(readme.contains(pad) && device.starts_with("device.restoring_force = \"100 nN\" "));
    let set = json!([["material.hardness", "9 GPa"], ["capillary.relative_humidity", "0.4"]]);
    let edited =
        ask(&mut lab, "edit", &json!({ "toml": own, "set": set, "unset": ["device.restoring_force"] }));
    let edited = edited["toml"].as_str().unwrap();
    assert!(
        edited.contains("hardness = \"9 GPa\"\n") && edited.contains("relative_humidity = 0.4"),
        "{edited}"
    );
    assert!(edited.contains("\"20 mJ/m^2\"   # dry") && !edited.contains("device"), "{edited}");
    let described = ask(&mut lab, "describe", &json!({ "toml": own }));
    let values = &described["values"];
    let hardness = json!({ "text": "12 GPa", "value": 12e9, "unit": "Pa", "given": true });
    assert_eq!(values["material.hardness"], hardness);
    assert_eq!(values["model.plastic_contact"]["text"], "jg");
    assert_eq!((&described["errors"], &described["preloads"]), (&json!([]), &json!([1e-4])));
    assert!(described["text"].as_str().unwrap().contains("10000 asperities per replica"));
    let wrong = own.replace("12 GPa", "12 nm").replace("model.history", "model.histry");
    let errors = ask(&mut lab, "describe", &json!({ "toml": wrong }))["errors"].clone();
    assert_eq!((&errors[0]["line"], &errors[0]["key"]), (&json!(3), &json!("material.hardness")));
    assert!(errors[1]["text"].as_str().unwrap().contains("did you mean `history`?"), "{errors}");
    let refused = refused(&mut lab, "prepare", &json!({ "toml": wrong }));
    assert!(refused["text"].as_str().unwrap().starts_with("line 3: "), "{refused}");
}

/// What a browser cannot or need not compute is refused before it is begun.
#[test]
fn what_is_not_for_a_page_is_refused() {
    let mut lab = lab();
    let swept = small() + "\n[sweep]\n\"material.hardness\" = [\"1 GPa\", \"2 GPa\"]\n";
    let few = small().replace("replicas = 40", "replicas = 0");
    let large = small().replace("\"100 um^2\"", "\"2.7e7 um^2\"");
    let named = small() + "\n[surface.heights]\nlaw = \"file\"\npath = \"a.csv\"\ncolumn = \"height\"\n";
    for (scene, problem) in [
        (swept, "has a table [sweep]"),
        (few, "`ensemble.replicas` = 0 asks for the integral alone"),
        (large, "the run would take about"),
        (named, "the file a.csv is not here"),
    ] {
        let refused = refused(&mut lab, "prepare", &json!({ "toml": scene }));
        assert!(refused["text"].as_str().unwrap().contains(problem), "{problem}: {refused}");
    }
}

/// Materials are those of the program.
#[test]
fn materials_are_listed() {
    let mut lab = lab();
    let materials = ask(&mut lab, "materials", &json!(""));
    assert_eq!(materials["materials"][0]["name"], "poly-Si");
    assert_eq!(materials["materials"][0]["numbers"][0]["value"], "169 GPa");
}

/// As `stiction.find_asperities` has them (NumPy and SciPy), with and without its filter.
#[test]
fn summits_of_a_map_are_those_of_the_package() {
    let mut lab = lab();
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/configs/maps/polished.txt")).unwrap();
    let unsmoothed = [6555863342566.944, 5.577376276512171e-6, 1.1559360520842005e-9, 1.4462083236060106e-9];
    let of_moments = [2.3729585018901075e-18, 6.259536156764118e-5, 14584438826.619036];
    let smoothed = [5532920879231.427, 6.763811421601382e-6, 1.1866072523940897e-9, 1.4446297218749134e-9];
    let of_smoothed = [2.3121684933470163e-18, 5.412292214773848e-5, 10181726657.6002];
    let names = ["density", "radius", "height_mean", "height_std", "m0", "m2", "m4"];
    for (smooth, count, summits, moments) in
        [(json!(null), 213, unsmoothed, of_moments), (json!("120 nm"), 176, smoothed, of_smoothed)]
    {
        let found = ask(&mut lab, "map", &json!({ "text": text, "smooth": smooth }));
        assert_eq!(found["summits"], count);
        for (name, expected) in names.iter().zip(summits.iter().chain(&moments)) {
            let own = found["values"][name].as_f64().unwrap();
            assert!((own / expected - 1.0).abs() < 1e-10, "{name}: {own} {expected}");
        }
        assert_eq!(found["warnings"], json!([]));
    }
    let pad = ask(&mut lab, "template", &json!("pad"))["toml"].clone();
    let found = ask(&mut lab, "map", &json!({ "text": text }));
    assert_eq!(found["set"][0], json!(["surface.asperity_radius", "5.57738 um"]));
    let edited = ask(&mut lab, "edit", &json!({ "toml": pad, "set": found["set"] }));
    assert_eq!(ask(&mut lab, "describe", &edited)["errors"], json!([]));
}

/// Plateaus count once, at their middle; maps of other kinds are refused with their place.
#[test]
fn maps_of_other_kinds_are_refused() {
    let mut lab = lab();
    let rows = |cell: &dyn Fn(usize, usize) -> String| -> String {
        (0..9).map(|y| (0..9).map(|x| cell(y, x)).collect::<Vec<String>>().join(" ") + "\n").collect()
    };
    // A plateau of three pixels, and a ridge to the border, which is none.
    let plateau = rows(&|y, x| match (y, x) {
        (4, 3..=5) => "2".to_owned(),
        (1, 0..=2) => "1".to_owned(),
        _ => "0".to_owned(),
    });
    let given = json!({ "text": plateau, "pixel": "10 nm,20 nm", "height_unit": "nm" });
    let found = ask(&mut lab, "map", &given);
    assert_eq!((&found["summits"], &found["extent"]), (&json!(1), &json!([9e-8, 1.8e-7])));
    let bare = rows(&|y, x| (y * x % 7).to_string());
    for (text, problem) in [
        (bare.clone(), "the map does not say its pixel"),
        (bare.replacen("6", "6,5", 1), "maps with decimal commas or missing heights"),
        (bare.replacen("6", "nan", 1), "line 2, column 7: \"nan\" is no height"),
        (bare.lines().take(5).map(|line| format!("{line}\n")).collect(), "the map has 5 rows and 9 columns"),
        (format!("{bare}1 2\n"), "line 10: has 2 heights, and the first row 9"),
    ] {
        let refused = refused(&mut lab, "map", &json!({ "text": text }));
        let text = refused["text"].as_str().unwrap();
        assert!(text.contains(problem), "{problem}: {text}");
    }
    let flat = rows(&|y, x| (3 * y + x).to_string());
    let flat = refused(&mut lab, "map", &json!({ "text": flat, "pixel": "10 nm", "height_unit": "nm" }));
    assert!(flat["text"].as_str().unwrap().starts_with("the levelled map is flat"), "{flat}");
    let short = json!({ "text": bare, "pixel": "10 nm", "height_unit": "nm", "smooth": "1 nm" });
    let short = refused(&mut lab, "map", &short);
    assert!(short["text"].as_str().unwrap().contains("from 20 nm, two pixels, to 45 nm"), "{short}");
}
