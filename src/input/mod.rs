//! Files that others have made: columns of numbers that scenes take values from.

pub mod columns;
