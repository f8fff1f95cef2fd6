//! Plain CSV tables: commas between columns, points in numbers, UTF-8, a name above each column with its unit if it
//! has one, comments behind `#`. Other dialects are refused by name: the Python package reads them.

use crate::scene::units::is_unit;
use csv::{Reader, ReaderBuilder, StringRecord, StringRecordsIntoIter, Trim};
use std::collections::HashMap;

/// What would do where a table is of another dialect.
const PLAIN: &str = "save it as CSV with commas between columns and points in numbers";
/// What spreadsheets and people write where nothing was measured, in lower case; their errors besides.
const GAPS: [&str; 9] = ["", "na", "n/a", "nan", "null", "none", "-", "--", "---"];
/// Longest text above a column that a unit is looked for in, bytes.
const LONGEST_HEAD: usize = 200;
/// Errors of spreadsheets that do not end like the others.
const ERRORS: [&str; 6] = ["#N/A", "#NA", "#NV", "#N/V", "#ND", "#N/D"];

/// A table that is read row by row.
#[derive(Debug)]
pub struct Table<'a> {
    /// What stands above the columns; none of a table without names.
    pub heads: Vec<Head>,
    text: &'a str,
    reader: Reader<&'a [u8]>,
    first: StringRecord,
}

/// What stands above a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Head {
    /// All of it.
    pub text: String,
    /// It without the unit.
    pub name: String,
    /// The unit, in brackets, behind a space or behind an underline.
    pub unit: Option<String>,
}

/// A row and its place.
#[derive(Debug)]
pub struct Row {
    /// The line, from 1.
    pub line: usize,
    /// The texts in the columns.
    pub fields: StringRecord,
}

/// The reason why a field is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoNumber {
    /// Nothing, or what stands for nothing.
    Gap,
    /// It has a comma.
    Comma,
    /// Any other text.
    Text,
}

impl NoNumber {
    /// It in words, behind "is".
    pub fn words(self) -> &'static str {
        match self {
            Self::Gap => "a gap: fill it, or take the line out",
            Self::Comma => "a number with a comma: save the table as CSV with points in numbers",
            Self::Text => "not a number",
        }
    }
}

/// The text of a table.
///
/// # Errors
/// It is in UTF-16 or in no encoding that is known here.
pub fn decoded(bytes: Vec<u8>) -> Result<String, String> {
    // Without a mark every other byte of plain text is 0.
    let half = |bytes: &[u8], from: usize| bytes.iter().skip(from).step_by(2).take(32).all(|&byte| byte == 0);
    let is_utf16 = |bytes: &[u8]| {
        let is_marked = matches!(bytes, [0xff, 0xfe, ..] | [0xfe, 0xff, ..]);
        is_marked || bytes.len() > 3 && half(bytes, 0) != half(bytes, 1)
    };
    if is_utf16(&bytes) {
        return Err("is a text in UTF-16; save it in UTF-8".to_owned());
    }
    String::from_utf8(bytes).map_err(|error| {
        let place = error.utf8_error().valid_up_to() + 1;
        format!("is not a text in UTF-8: byte {place} belongs to no character")
    })
}

impl<'a> Table<'a> {
    /// The table of a text whose first line has the names.
    ///
    /// # Errors
    /// The problem, behind its line; nothing of the text is in it.
    pub fn named(text: &'a str) -> Result<Self, String> {
        let table = Self::new(text)?;
        let heads: Vec<Head> = table.first.iter().map(Head::new).collect();
        let mut names = HashMap::new();
        for (i, head) in heads.iter().enumerate().filter(|(_, head)| !head.name.is_empty()) {
            if let Some(j) = names.insert(head.name.to_lowercase(), i) {
                let line = line_of(table.text, &table.first).0;
                return Err(format!("line {line}: columns {} and {} have one name", j + 1, i + 1));
            }
        }
        Ok(Self { heads, ..table })
    }

    /// The table of a text of numbers alone.
    ///
    /// # Errors
    /// As of [`Self::named`].
    pub fn bare(text: &'a str) -> Result<Self, String> {
        Self::new(text)
    }

    fn new(text: &'a str) -> Result<Self, String> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if let Some(line) = text.split('\n').position(|line| line.trim_end_matches('\r').contains('\r')) {
            return Err(format!("line {}: it ends with CR alone; save it with LF or CRLF", line + 1));
        }
        if let Some(line) = text.lines().position(is_error_first) {
            return Err(format!("line {}: column 1 has {}", line + 1, NoNumber::Gap.words()));
        }
        let mut builder = ReaderBuilder::new();
        builder.has_headers(false).flexible(true).comment(Some(b'#')).trim(Trim::All);
        let mut table = Self {
            heads: Vec::new(),
            text,
            reader: builder.from_reader(text.as_bytes()),
            first: StringRecord::new(),
        };
        while table.reader.read_record(&mut table.first).unwrap_or(false)
            && is_no_row(line_of(text, &table.first).1)
        {}
        let names = line_of(text, &table.first).0;
        if let Some(line) = hidden_row(text, names, table.first.len()) {
            return Err(format!(
                "line {line}: begins with #, as a comment, and has the cells of a row; put quotes around the label, \
                 or take the line out"
            ));
        }
        if table.first.len() == 1 {
            let separator =
                [(';', "semicolons"), ('\t', "tabs")].into_iter().find(|(c, _)| table.first[0].contains(*c));
            if let Some((_, separators)) = separator {
                return Err(format!(
                    "line {}: columns are separated by {separators}; {PLAIN}",
                    line_of(text, &table.first).0
                ));
            }
        }
        Ok(table)
    }

    /// The place of the column with a name, in letters of any case, without its unit or with it.
    pub fn place(&self, name: &str) -> Option<usize> {
        let exact = self.heads.iter().position(|head| head.text == name);
        exact.or_else(|| self.heads.iter().position(|head| head.is(name)))
    }

    /// The rows, each with as many fields as the first line.
    pub fn rows(self) -> Rows<'a> {
        let columns = self.first.len();
        let first = Some(self.first).filter(|first| self.heads.is_empty() && !first.is_empty());
        Rows { text: self.text, columns, first, rest: self.reader.into_records() }
    }
}

/// The rows of a table.
pub struct Rows<'a> {
    text: &'a str,
    columns: usize,
    first: Option<StringRecord>,
    rest: StringRecordsIntoIter<&'a [u8]>,
}

impl Iterator for Rows<'_> {
    type Item = Result<Row, String>;

    fn next(&mut self) -> Option<Self::Item> {
        let text = self.text;
        let is_row = |record: &csv::Result<StringRecord>| {
            !record.as_ref().is_ok_and(|record| is_no_row(line_of(text, record).1))
        };
        let fields = match self.first.take() {
            Some(first) => first,
            None => match self.rest.by_ref().find(is_row)? {
                Ok(fields) => fields,
                Err(error) => return Some(Err(error.to_string())),
            },
        };
        let (line, count) = (line_of(text, &fields).0, fields.len());
        if fields.iter().any(|field| field.contains('\n')) {
            return Some(Err(format!("line {line}: a quotation mark is not closed in it")));
        }
        if count != self.columns {
            let comma = if count > self.columns { "; a number has a point, no comma" } else { "" };
            return Some(Err(format!(
                "line {line}: has {count} fields, and the first line {}{comma}",
                self.columns
            )));
        }
        Some(Ok(Row { line, fields }))
    }
}

impl Head {
    fn new(text: &str) -> Self {
        let text = text.trim();
        let split = |name: &str, unit: &str| Self {
            text: text.to_owned(),
            name: name.trim().to_owned(),
            unit: Some(unit.trim().to_owned()).filter(|unit| !unit.is_empty()),
        };
        if text.len() > LONGEST_HEAD {
            return split(text, "");
        }
        let bracket = text.strip_suffix([')', ']']).and_then(|rest| rest.split_once(['(', '[']));
        if let Some((name, unit)) = bracket {
            return split(name, unit);
        }
        let places = text.char_indices().filter(|(_, c)| matches!(c, ' ' | '_'));
        let mut parts = places.map(|(i, _)| (&text[..i], &text[i + 1..]));
        match parts.find(|(name, unit)| !name.is_empty() && is_unit(unit)) {
            Some((name, unit)) => split(name, unit),
            None => split(text, ""),
        }
    }

    /// Whether that is its name, in letters of any case.
    fn is(&self, name: &str) -> bool {
        self.name.to_lowercase() == name.trim().to_lowercase()
    }
}

impl Row {
    /// The number in a column.
    ///
    /// # Errors
    /// [`NoNumber`].
    pub fn number(&self, place: usize) -> Result<f64, NoNumber> {
        let field = self.fields.get(place).unwrap_or_default();
        if is_gap(field) {
            return Err(NoNumber::Gap);
        }
        let is_number = |text: &str| text.parse::<f64>().is_ok();
        match field.parse() {
            Ok(number) => Ok(number),
            Err(_) if field.contains(',') && is_number(&field.replacen(',', ".", 1)) => Err(NoNumber::Comma),
            Err(_) => Err(NoNumber::Text),
        }
    }
}

/// The line of a record, from 1, and its text. The reader's own place is before the comments and empty lines that it
/// has skipped.
fn line_of<'t>(text: &'t str, record: &StringRecord) -> (usize, &'t str) {
    let (line, byte) = record.position().map_or((1, 0), |place| (place.line(), place.byte()));
    let rest = usize::try_from(byte).ok().and_then(|byte| text.get(byte..)).unwrap_or_default();
    let mut lines = rest.split('\n').enumerate();
    let (skipped, own) = lines.find(|(_, line)| !is_skipped(line)).unwrap_or((0, rest));
    (usize::try_from(line).unwrap_or(usize::MAX).saturating_add(skipped), own)
}

/// Whether the reader skips a line itself.
fn is_skipped(line: &str) -> bool {
    line.starts_with('#') || line.trim_end_matches('\r').is_empty()
}

/// Whether a line is blank or a comment behind spaces.
fn is_no_row(line: &str) -> bool {
    let line = line.trim();
    line.is_empty() || line.starts_with('#')
}

/// The line, from 1, of a row below the first that begins with `#`: it has as many cells, and behind the first numbers or
/// nothing, or `##`, as spreadsheets write for a number in a narrow column.
fn hidden_row(text: &str, first: usize, columns: usize) -> Option<usize> {
    let is_row = |line: &str| {
        let line = line.trim();
        if columns > 1 {
            let others = line.split(',').skip(1).map(|cell| cell.trim_matches(['"', ' ']));
            let is_row =
                others.clone().any(|cell| cell.parse::<f64>().is_ok()) || others.clone().all(str::is_empty);
            line.starts_with('#') && others.count() + 1 == columns && (line.starts_with("##") || is_row)
        } else {
            columns == 1 && line.len() > 1 && line.chars().all(|c| c == '#')
        }
    };
    text.lines().enumerate().skip(first).find(|(_, line)| is_row(line)).map(|(i, _)| i + 1)
}

/// Whether a line begins with the error of a spreadsheet, which is no comment.
fn is_error_first(line: &str) -> bool {
    line.trim_start().starts_with('#') && is_error(line.split(',').next().unwrap_or_default().trim())
}

/// Whether nothing was measured where this is written.
fn is_gap(field: &str) -> bool {
    GAPS.contains(&field.to_lowercase().as_str()) || is_error(field)
}

/// Whether a text is the error of a spreadsheet, such as `#REF!`, in any language.
fn is_error(field: &str) -> bool {
    let marked = field.strip_prefix('#').and_then(|rest| rest.strip_suffix(['!', '?']));
    let is_word = |word: &str| {
        !word.is_empty()
            && word.chars().all(|c| c.is_uppercase() || c.is_ascii_digit() || matches!(c, '/' | '_'))
    };
    ERRORS.contains(&field) || marked.is_some_and(is_word)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of the first column of a table with names, or what is wrong.
    fn numbers(text: &str) -> Result<Vec<f64>, String> {
        let row = |row: Result<Row, String>| {
            let row = row?;
            row.number(0).map_err(|no| format!("line {}: {}", row.line, no.words()))
        };
        Table::named(text)?.rows().map(row).collect()
    }

    #[test]
    fn plain_tables_of_other_programs_are_read() {
        let texts = [
            "\u{feff}height,note\r\n1,a\r\n2.5,b\r\n",
            "# measured\nheight,note\n  # again, \"so\n1,a\n# \"and\n2.5,b\n",
            "# a, b\nheight,note\n1,a\n# of Monday\n#\n# a, b, c\n2.5,\"#b\"\n",
            "height\n1\n#\n# note\n2.5\n",
            "\"height\",\"note\"\n\"1\",\"a, b\"\n\n\"2.5\",b",
        ];
        for text in texts {
            assert_eq!(numbers(text), Ok(vec![1.0, 2.5]), "{text}");
        }
        let bare = Table::bare("\u{feff}1,2\n3,4\n").unwrap().rows().map(|row| row.unwrap().number(1));
        assert_eq!(bare.collect::<Vec<_>>(), [Ok(2.0), Ok(4.0)]);
    }

    #[test]
    fn units_are_read_as_people_write_them() {
        for (text, name, unit) in [
            ("force (uN)", "force", Some("uN")),
            ("force [uN]", "force", Some("uN")),
            ("force uN", "force", Some("uN")),
            ("force_uN", "force", Some("uN")),
            ("pull-off force in (µN)", "pull-off force in", Some("µN")),
            ("work_of_adhesion mJ m^-2", "work_of_adhesion", Some("mJ m^-2")),
            ("work_of_adhesion", "work_of_adhesion", None),
            ("force (large)", "force", Some("large")),
            ("nm", "nm", None),
        ] {
            let head = Head::new(text);
            assert_eq!((head.name.as_str(), head.unit.as_deref()), (name, unit), "{text}");
        }
        let table = Table::named("Height (nm),radius\n").unwrap();
        let places = ["height", "Height (nm)", "RADIUS", "nm"].map(|name| table.place(name));
        assert_eq!(places, [Some(0), Some(0), Some(1), None]);
    }

    #[test]
    fn other_dialects_and_gaps_are_refused_by_their_line() {
        for (text, problem) in [
            ("height;note\n1;2\n", "line 1: columns are separated by semicolons; save it as CSV"),
            ("# a\nheight\tnote\n1\t2\n", "line 2: columns are separated by tabs"),
            ("height\n1,5\n", "line 2: has 2 fields, and the first line 1; a number has a point"),
            ("height\n1\n\"1,5\"\n", "line 3: a number with a comma"),
            ("height,note\n1\n", "line 2: has 1 fields, and the first line 2"),
            ("height\r1\r2\r", "line 1: it ends with CR alone"),
            ("height,Height (nm)\n1,2\n", "line 1: columns 1 and 2 have one name"),
            ("height,note\n#N/A,2\n", "line 2: column 1 has a gap"),
            ("height,note\n  #BEZUG!,2\n", "line 2: column 1 has a gap"),
            ("height,note\n\"1,2\n3,4\n", "line 2: a quotation mark is not closed in it"),
            ("height,note\n5_2.6,2\n", "line 2: not a number"),
            ("height,note\n1,2\n#2,\n", "line 3: begins with #, as a comment"),
            ("height,note\n1,2\n  #2 (repeat),2\n", "line 3: begins with #, as a comment"),
            ("# a\nheight,note\n#####,2\n", "line 3: begins with #, as a comment"),
            ("height\n1\n#####\n", "line 3: begins with #, as a comment"),
        ] {
            let found = numbers(text).unwrap_err();
            assert!(found.starts_with(problem), "{text:?}: {found}");
        }
        for gap in ["", "NA", "n/a", "--", "NaN", "#REF!", "#NAME?", "#DIV/0!"] {
            assert!(numbers(&format!("height,note\n\"{gap}\",2\n")).unwrap_err().contains("gap"), "{gap}");
        }
        assert!(
            decoded("a\n1\n".encode_utf16().flat_map(u16::to_le_bytes).collect())
                .unwrap_err()
                .contains("UTF-16")
        );
        assert!(decoded(b"\xfe\xff\0a".to_vec()).unwrap_err().contains("UTF-16"));
        assert!(decoded(b"force (\xb5N)\n".to_vec()).unwrap_err().contains("byte 8"));
    }
}
