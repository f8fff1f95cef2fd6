//! CSV tables: a line of names, and behind it rows of numbers.

use crate::scene::echo::shortened;

/// A table that is read row by row.
pub(super) struct Table<'a> {
    /// The names of the columns.
    pub header: Vec<&'a str>,
    body: std::str::Lines<'a>,
}

/// A row and its place.
pub(super) struct Row<'a> {
    /// The line, from 1.
    pub line: usize,
    /// The texts in the columns.
    pub fields: Vec<&'a str>,
}

fn fields(line: &str) -> Vec<&str> {
    line.split(',').map(str::trim).collect()
}

impl<'a> Table<'a> {
    /// The table of a text.
    pub fn new(text: &'a str) -> Self {
        let mut body = text.lines();
        Self { header: fields(body.next().unwrap_or_default()), body }
    }

    /// The place of a column, if it is there.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| *column == name)
    }

    /// The rows, without empty lines.
    pub fn rows(&self) -> impl Iterator<Item = Row<'a>> + use<'a> {
        let lines = self.body.clone().enumerate().filter(|(_, line)| !line.trim().is_empty());
        lines.map(|(i, line)| Row { line: i + 2, fields: fields(line) })
    }
}

impl Row<'_> {
    /// The text in a column, empty where the row ends before it.
    pub fn field(&self, column: usize) -> &str {
        self.fields.get(column).copied().unwrap_or_default()
    }

    /// The number in a column of that name.
    pub fn number(&self, column: usize, name: &str) -> Result<f64, String> {
        let field = self.field(column);
        field.parse().map_err(|_| self.wrong(name, field, "is not a number"))
    }

    /// An error about the text in a column.
    pub fn wrong(&self, name: &str, field: &str, problem: &str) -> String {
        self.at(&format!("{name} = `{}` {problem}", shortened(field)))
    }

    /// An error about the row.
    pub fn at(&self, problem: &str) -> String {
        format!("line {}: {problem}", self.line)
    }
}
