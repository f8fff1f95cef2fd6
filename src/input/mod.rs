//! Files that others have made: tables, columns of numbers that scenes take values from, and height maps.

pub mod columns;
pub mod maps;
pub mod table;
