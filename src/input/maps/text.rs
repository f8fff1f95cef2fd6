//! Grids of numbers in a text, as the programs of instruments export them: a row of the map on each line, its
//! numbers separated by tabs, semicolons, commas or blanks, behind a header. Of the header `Width`, `Height`
//! and `Value units` count, as Gwyddion writes them.

use super::{RawMap, within};
use crate::scene::echo::shortened;
use crate::scene::units::{Dimension, parse};
use std::io::BufRead;

/// Longest line, bytes.
const LONGEST_LINE: u64 = 1 << 24;
/// Beginnings of lines that are no rows, wherever they are.
const COMMENTS: [&str; 3] = ["#", "%", "//"];

pub(super) fn read(mut file: impl BufRead, length: u64, most: u64) -> Result<RawMap, String> {
    let mut grid = Grid::default();
    let mut bytes = Vec::new();
    for number in 1.. {
        bytes.clear();
        let read = std::io::Read::take(&mut file, LONGEST_LINE).read_until(b'\n', &mut bytes);
        let read = read.map_err(|error| format!("cannot be read: {error}"))? as u64;
        if read == 0 {
            break;
        }
        if read == LONGEST_LINE {
            return Err(format!("line {number}: is longer than {} MB", LONGEST_LINE >> 20));
        }
        let line = decoded(&bytes);
        let line = if number == 1 { line.trim_start_matches('\u{feff}') } else { &line };
        grid.line(line.trim()).map_err(|problem| format!("line {number}: {problem}"))?;
        if grid.rows == 1 && grid.expected == 0 {
            // All lines are about as long as the first.
            let expected = (length / read).max(1);
            grid.expected = within([expected / 2, grid.columns as u64], most)?[0].max(1);
        }
        within([grid.rows as u64, grid.columns as u64], most)?;
    }
    grid.map()
}

/// A line as a text; of what is no UTF-8 each byte is a character, as in Latin-1, which older programs write.
fn decoded(bytes: &[u8]) -> String {
    match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
    }
}

/// The contents of the lines so far.
#[derive(Default)]
struct Grid {
    heights: Vec<f64>,
    rows: usize,
    columns: usize,
    /// Rows that the length of the text lets expect at least; 0 before the first.
    expected: usize,
    extent: [Option<f64>; 2],
    unit: Option<String>,
}

impl Grid {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let comment = COMMENTS.iter().find_map(|mark| line.strip_prefix(mark));
        if line.is_empty() {
            return Ok(());
        }
        let mut fields = fields(line);
        // Before the first row every line that does not begin with a number, be it with a decimal comma,
        // belongs to the header.
        let is_row = self.rows > 0 || fields[0].replace(',', ".").parse::<f64>().is_ok();
        if let Some(header) = comment.or_else(|| (!is_row).then_some(line)) {
            self.header(header);
            return Ok(());
        }
        // A separator may end the line too.
        if fields.len() > 1 && fields.last() == Some(&"") {
            fields.pop();
        }
        for (column, field) in fields.iter().enumerate() {
            let height = field.parse::<f64>().map_err(|_| not_a_number(line, column, field))?;
            self.heights.push(height);
        }
        if self.rows > 0 && fields.len() != self.columns {
            return Err(format!(
                "has {} numbers, and the rows before it have {}",
                fields.len(),
                self.columns
            ));
        }
        (self.rows, self.columns) = (self.rows + 1, fields.len());
        Ok(())
    }

    /// Takes what counts from a line of the header.
    fn header(&mut self, line: &str) {
        let Some((key, value)) = line.split_once(':') else { return };
        let length =
            || parse(value, Dimension::Length).ok().filter(|length| *length > 0.0 && length.is_finite());
        match key.trim().to_ascii_lowercase().as_str() {
            "height" => self.extent[0] = length().or(self.extent[0]),
            "width" => self.extent[1] = length().or(self.extent[1]),
            "value units" => self.unit = Some(value.trim().to_owned()).filter(|unit| !unit.is_empty()),
            _ => {}
        }
    }

    fn map(self) -> Result<RawMap, String> {
        let Self { heights, rows, columns, extent, unit, .. } = self;
        match (rows, columns) {
            (0, _) => Err(
                "holds no row of numbers; NPY, HDF5, or a text with a row of the map on each line is needed"
                    .to_owned(),
            ),
            (_, 3) => Err(
                "has 3 numbers on each line, as lists of points x, y, z have; a grid of heights is needed"
                    .to_owned(),
            ),
            _ => Ok(RawMap { heights, shape: [rows, columns], extent, unit, dataset: None }),
        }
    }
}

/// The numbers of a line, as texts: at least one. The first of tab, semicolon and comma that is there
/// separates them, else blanks.
fn fields(line: &str) -> Vec<&str> {
    match ['\t', ';', ','].into_iter().find(|separator| line.contains(*separator)) {
        Some(separator) => line.split(separator).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    }
}

fn not_a_number(line: &str, column: usize, field: &str) -> String {
    let field = shortened(field);
    let advice = if field.is_empty() {
        "write nan where a height is missing"
    } else if line.contains(',') && (field.contains(',') || field.contains(' ')) {
        "decimal points are needed, not commas"
    } else {
        "lines that are no rows begin with #"
    };
    format!("column {}: `{field}` is not a number; {advice}", column + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read_text(text: &[u8]) -> Result<RawMap, String> {
        read(text, text.len() as u64, 1 << 20)
    }

    #[test]
    fn separators_and_headers_give_the_same_map() {
        let expected = RawMap {
            heights: vec![1.0, 2.5, -3e-9, 4.0],
            shape: [2, 2],
            extent: [None; 2],
            unit: None,
            dataset: None,
        };
        for text in [
            "1 2.5\n-3e-9 4\n",
            "1\t2.5\r\n-3e-9\t4\r\n",
            "\u{feff}1, 2.5\n-3e-9, 4,\n",
            "1;2.5;\n-3e-9;4;\n\n",
            "Scan of 2026\nx [nm]; y [nm]\n  1   2.5 \n# half way\n  -3e-9   4",
        ] {
            assert_eq!(read_text(text.as_bytes()).as_ref(), Ok(&expected), "{text}");
        }
    }

    #[test]
    fn a_header_gives_extent_and_unit() {
        let text = "# Channel: Topography\n# Width: 2.0 \u{b5}m\n# Height: 500 nm\n# Value units: m\n1e-9\tnan\n2e-9\t3e-9\n";
        let latin: Vec<u8> = text.chars().map(|c| c as u8).collect();
        for bytes in [text.as_bytes(), &latin] {
            let map = read_text(bytes).unwrap();
            assert_eq!((map.extent, map.unit.as_deref()), ([Some(5e-7), Some(2e-6)], Some("m")));
            assert!(map.heights[1].is_nan() && map.heights[3] == 3e-9);
        }
    }

    #[test]
    fn what_is_no_grid_is_named_by_its_line() {
        for (text, part) in [
            ("1 2\n3\n", "line 2: has 1 numbers, and the rows before it have 2"),
            ("1 2\n3 x\n", "line 2: column 2: `x` is not a number; lines that are no rows begin with #"),
            ("1 2 3 y\n", "line 1: column 4: `y`"),
            ("1,,2\n", "line 1: column 2: `` is not a number; write nan"),
            ("1,5\t2,5\n", "line 1: column 1"),
            ("1,5 2,5\n", "decimal points are needed"),
            ("", "holds no row of numbers"),
            ("only words\n", "holds no row of numbers"),
            ("1 2 3\n4 5 6\n", "lists of points"),
        ] {
            let error = read_text(text.as_bytes()).unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
        let error = read(&b"1 2 4 5\n1 2 4 5\n1 2 4 5\n"[..], 24, 10).unwrap_err();
        assert!(error.contains("10 can be read here"), "{error}");
    }

    #[test]
    fn long_lines_end() {
        let line = "1 ".repeat((LONGEST_LINE as usize) / 2 + 1);
        assert!(read_text(line.as_bytes()).unwrap_err().contains("longer than 16 MB"));
    }
}
