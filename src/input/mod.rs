//! Files that others have made: tables, and columns of numbers that scenes take values from.

pub mod columns;
pub mod table;
