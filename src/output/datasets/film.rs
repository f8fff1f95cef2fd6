//! Films of liquid on the surfaces.

use super::{Dataset, History, Results, path};
use crate::integral::Films;
use crate::liquid::Film;
use crate::output::schema::Dimension::Separation;

const GROUP: &str = "/film";

pub(super) fn datasets() -> Vec<Dataset> {
    let before = "thickness of the films before they drain";
    let in_law = "thickness of the films in the law of all replicas: that at pull-off";
    let mut all = vec![
        Dataset::new(path(GROUP, "initial_thickness"), &[], "m", before, |results| {
            Some(results.scene.draining_film.unwrap_or(film(results)?.thickness))
        }),
        Dataset::new(path(GROUP, "law_thickness"), &[], "m", in_law, |results| {
            Some(film(results)?.thickness)
        }),
    ];
    all.extend(History::all().flat_map(of_history));
    all
}

fn film(results: &Results) -> Option<Film> {
    results.scene.model.meniscus()?.film
}

fn of_history(history: History) -> [Dataset; 2] {
    let thickness = history.meaning("thickness of the films{}, drained into the expected bridges");
    let words = "external force of the integral{} with the films of each separation, compressive positive";
    let films = move |results: &Results| -> Option<Films> {
        film(results)?;
        results.scene.films.get(results.scene.ways().first() + history.place).cloned()
    };
    [
        Dataset::new(history.path(GROUP, "thickness"), &[Separation], "m", thickness, move |results| {
            Some(films(results)?.thickness)
        }),
        Dataset::new(
            history.path(GROUP, "external_force"),
            &[Separation],
            "N",
            history.meaning(words),
            move |results| Some(films(results)?.external_force),
        ),
    ]
}
