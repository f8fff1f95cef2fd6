//! Arrays of NumPy.

use super::{RawMap, not_two, within};
use npyz::{Deserialize, NpyFile, NpyHeader, Order};
use std::io::{Chain, Cursor, Read};

/// Longest header, bytes, of an array of numbers in two dimensions; that of NumPy has 118.
const LONGEST_HEADER: u32 = 1024;
/// Bytes of an element at least.
const SMALLEST_ELEMENT: u64 = 1;

/// An array whose header has been looked at.
type Source<R> = Chain<Cursor<Vec<u8>>, R>;

pub(super) fn read(file: impl Read, length: u64, most: u64) -> Result<RawMap, String> {
    let source = bounded(file)?;
    let array = NpyFile::new(source).map_err(|error| format!("is an NPY file that is damaged: {error}"))?;
    let header: &NpyHeader = array.header();
    let &[rows, columns] = header.shape() else { return Err(not_two(header.shape())) };
    let (shape, order) = (within([rows, columns], most)?, header.order());
    let element = header.dtype().num_bytes().map_or(SMALLEST_ELEMENT, |bytes| bytes as u64);
    if rows * columns > length / element.max(SMALLEST_ELEMENT) {
        return Err("has more values than the file holds".to_owned());
    }
    let stored = numbers(array)?;
    let heights = match order {
        Order::C => stored,
        Order::Fortran => transposed(&stored, shape),
    };
    Ok(RawMap { heights, shape, extent: [None; 2], unit: None, dataset: None })
}

/// Refuses a header that claims to be longer than there is need for, before it is read.
fn bounded<R: Read>(mut file: R) -> Result<Source<R>, String> {
    let mut beginning = vec![0; 12];
    file.read_exact(&mut beginning)
        .map_err(|_| "is an NPY file that is damaged: it ends in its header".to_owned())?;
    let length = match beginning[6] {
        1 => u32::from(u16::from_le_bytes([beginning[8], beginning[9]])),
        _ => u32::from_le_bytes([beginning[8], beginning[9], beginning[10], beginning[11]]),
    };
    if length > LONGEST_HEADER {
        return Err(format!(
            "is an NPY file with a header of {length} bytes, which no plain array of numbers has"
        ));
    }
    Ok(Cursor::new(beginning).chain(file))
}

/// The numbers of an array, whatever kind they are of.
fn numbers<R: Read>(array: NpyFile<R>) -> Result<Vec<f64>, String> {
    let array = match of_kind::<f64, R>(array, |value| value) {
        Ok(values) => return values,
        Err(array) => array,
    };
    let array = match of_kind::<f32, R>(array, f64::from) {
        Ok(values) => return values,
        Err(array) => array,
    };
    // Whole numbers, as analogue-digital converters give them, of 8, 16, 32 and 64 bits with and without
    // sign.
    macro_rules! whole {
        ($array:expr, $($kind:ty),*) => {{
            let array = $array;
            $(let array = match of_kind::<$kind, R>(array, |value| value as f64) {
                Ok(values) => return values,
                Err(array) => array,
            };)*
            array
        }};
    }
    let array = whole!(array, i8, i16, i32, i64, u8, u16, u32, u64);
    let descriptor = crate::scene::echo::shortened(&array.dtype().descr());
    Err(format!("holds values of the type {descriptor}; real numbers of up to 64 bits are needed"))
}

/// The numbers of an array if they are of the kind `T`, or the array.
fn of_kind<T: Deserialize, R: Read>(
    array: NpyFile<R>,
    number: impl Fn(T) -> f64,
) -> Result<Result<Vec<f64>, String>, NpyFile<R>> {
    let reader = array.try_data::<T>()?;
    let values: std::io::Result<Vec<f64>> = reader.map(|value| value.map(&number)).collect();
    Ok(values.map_err(|_| "is an NPY file that ends before its last value".to_owned()))
}

/// Row-major what was column-major.
fn transposed(stored: &[f64], [rows, columns]: [usize; 2]) -> Vec<f64> {
    (0..rows * columns).map(|place| stored[place % columns * rows + place / columns]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file by its header's dictionary and its values' bytes.
    fn file(dictionary: &str, values: &[u8]) -> Vec<u8> {
        let header = format!("{dictionary}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(values);
        bytes
    }

    fn read_file(bytes: &[u8]) -> Result<RawMap, String> {
        read(bytes, bytes.len() as u64, 1 << 20)
    }

    #[test]
    fn kinds_and_orders_give_the_same_map() {
        let whole = [1_i16, 2, 3, 4, 5, 6];
        let little: Vec<u8> = whole.iter().flat_map(|value| value.to_le_bytes()).collect();
        let map =
            read_file(&file("{'descr': '<i2', 'fortran_order': False, 'shape': (2, 3), }", &little)).unwrap();
        assert_eq!((map.heights.as_slice(), map.shape), (&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0][..], [2, 3]));
        let big: Vec<u8> =
            [1_f64, 4.0, 2.0, 5.0, 3.0, 6.0].iter().flat_map(|value| value.to_be_bytes()).collect();
        let columns =
            read_file(&file("{'descr': '>f8', 'fortran_order': True, 'shape': (2, 3), }", &big)).unwrap();
        assert_eq!(columns, map);
    }

    #[test]
    fn headers_are_not_trusted() {
        let refused = |dictionary: &str, part: &str| {
            let error = read_file(&file(dictionary, &[0; 64])).unwrap_err();
            assert!(error.contains(part), "{dictionary}: {error}");
        };
        refused(
            "{'descr': '<f8', 'fortran_order': False, 'shape': (8, 9), }",
            "more values than the file holds",
        );
        refused(
            "{'descr': '<f8', 'fortran_order': False, 'shape': (9000000000, 9000000000), }",
            "can be read here",
        );
        refused(
            "{'descr': '<f8', 'fortran_order': False, 'shape': (8,), }",
            "shape 8; a map has two dimensions",
        );
        refused("{'descr': '<f8', 'fortran_order': False, 'shape': (), }", "single number");
        refused("{'descr': '<c16', 'fortran_order': False, 'shape': (2, 2), }", "real numbers");
        refused("{'descr': '|O', 'fortran_order': False, 'shape': (2, 2), }", "real numbers");
        refused("{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (2, 2), }", "real numbers");
        refused("{'descr': '<f8', 'shape': (2, 2), }", "damaged");
        refused(&"(".repeat(1000), "damaged");
        refused(&" ".repeat(2000), "a header of 2001 bytes");
        let mut long = file("", &[]);
        (long[6], long[8], long[9]) = (2, 0xff, 0xff);
        long.extend([0xff, 0xff, 0, 0]);
        assert!(read_file(&long).unwrap_err().contains("bytes, which no plain array"));
        assert!(read_file(b"\x93NUMPY").unwrap_err().contains("ends in its header"));
    }
}
