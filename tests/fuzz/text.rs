//! Scenes and tables changed token by token, so that most of them get past the parser and into what checks
//! the values.

use std::borrow::Cow;

/// What is done to one token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// A number, or that of a quantity, becomes an extreme one.
    Number,
    /// One digit becomes another.
    Digit,
    /// A quantity gets another unit.
    Unit,
    /// A word becomes another one that scenes know, or none.
    Word,
    /// Nested arrays or tables take the token's place.
    Nest,
    /// A long array takes its place.
    Array,
    /// Something that is no plain text is put in.
    Insert,
    /// The token goes.
    Drop,
    /// It is there several times.
    Repeat,
    /// It changes places with another.
    Swap,
    /// Its line goes.
    DropLine,
    /// Its line is there twice.
    RepeatLine,
    /// One bit of it is another.
    Flip,
    /// The text ends before it.
    Truncate,
}

/// The milder ones more often, so that scenes are accepted and refused alike.
const WEIGHTS: [(Change, usize); 14] = [
    (Change::Digit, 20),
    (Change::Number, 5),
    (Change::Unit, 2),
    (Change::Word, 3),
    (Change::Nest, 1),
    (Change::Array, 1),
    (Change::Insert, 1),
    (Change::Drop, 1),
    (Change::Repeat, 1),
    (Change::Swap, 1),
    (Change::DropLine, 1),
    (Change::RepeatLine, 1),
    (Change::Flip, 1),
    (Change::Truncate, 1),
];

/// Each change as often as its weight.
pub fn changes() -> Vec<Change> {
    WEIGHTS.iter().flat_map(|(change, weight)| std::iter::repeat_n(*change, *weight)).collect()
}

/// A change, the token that it is of, and what it takes: both counted round.
pub type Mutation = (Change, u32, u32);

const NUMBERS: &str = "0 -0 0.0 -0.0 1 -1 2 3 1e308 -1e308 1.7976931348623157e308 1e309 5e-324 1e-324 2.2e-308 nan -nan inf \
    -inf +inf 18446744073709551615 18446744073709551616 9223372036854775807 -9223372036854775808 1e12 1e-12 \
    1e-6 1e6 0x7fffffffffffffff 0xFF 0o17 0b11 1_000_000 1e99999999999999999999 1e-99999999999999999999 0.1 \
    0.5 1e-160 1e160 1e-3 1e3 1. .5 1979-05-27T07:32:00Z";

const UNITS: [&str; 22] = [
    "m",
    "mm",
    "um",
    "µm",
    "μm",
    "nm",
    "Å",
    "angstrom",
    "pm",
    "m^2",
    "um²",
    "nm^2",
    "/um^2",
    "1/nm^2",
    "Pa",
    "TPa",
    "J/m^2",
    "mN/m",
    "",
    "parsec",
    "\\u001b[31m",
    "²",
];

const WORDS: &str = "format title material surface model separation ensemble solver output reduced_modulus hardness \
    poisson_ratio work_of_adhesion equilibrium_spacing asperity_radius asperity_density surface_height_std \
    asperity_height_std mean_plane_offset nominal_area lubricant_thickness law path critical_approach h \
    h_star from to count replicas sampling seed sum tolerance curves hybrid emd fit:paper isbl sbl ke md \
    md_kim jkr dmt idmt gw approach retraction antithetic stratified compressed true a.b.c ключ";

const INSERTIONS: [&str; 18] = [
    "\0",
    "\u{1b}[2J",
    "\u{9b}31m",
    "\r",
    "\u{202e}",
    "\u{feff}",
    "\"",
    "'",
    "\"\"\"",
    "'''",
    "#",
    "\\",
    "\\u001b",
    "\\uD800",
    "=",
    "[[",
    "\u{10ffff}",
    ".",
];

/// The text after some changes.
pub fn changed(text: &str, mutations: &[Mutation]) -> String {
    let mut tokens: Vec<Cow<'_, str>> = tokens(text).into_iter().map(Cow::Borrowed).collect();
    for &(change, place, choice) in mutations {
        if tokens.is_empty() {
            break;
        }
        let place = suitable(&tokens, change, place as usize % tokens.len());
        apply(&mut tokens, change, place, choice as usize);
    }
    tokens.concat()
}

/// The next token from `place` on that a change is made for, or `place`.
fn suitable(tokens: &[Cow<'_, str>], change: Change, place: usize) -> usize {
    let fits = |token: &str| match change {
        Change::Number | Change::Digit => token.contains(|c: char| c.is_ascii_digit()),
        Change::Unit => token.starts_with('"') && token.contains(|c: char| c.is_ascii_digit()),
        Change::Word => token.contains(|c: char| c.is_ascii_alphabetic()) && !token.starts_with('#'),
        Change::Drop | Change::Swap | Change::Repeat | Change::Nest | Change::Array => {
            !token.trim().is_empty()
        }
        _ => true,
    };
    (place..tokens.len()).chain(0..place).find(|&i| fits(&tokens[i])).unwrap_or(place)
}

fn apply(tokens: &mut Vec<Cow<'_, str>>, change: Change, place: usize, choice: usize) {
    let token = tokens[place].clone();
    match change {
        Change::Number => {
            let number = one_of(NUMBERS, choice);
            let changed = match quantity(&token) {
                Some((_, unit)) => format!("\"{number}{unit}\""),
                None => number.to_owned(),
            };
            tokens[place] = changed.into();
        }
        Change::Digit => {
            let digits: Vec<usize> =
                token.match_indices(|c: char| c.is_ascii_digit()).map(|(i, _)| i).collect();
            if !digits.is_empty() {
                let at = digits[choice % digits.len()];
                tokens[place].to_mut().replace_range(at..=at, &(choice / 8 % 10).to_string());
            }
        }
        Change::Unit => {
            let number = quantity(&token).map_or("1", |(number, _)| number).to_owned();
            let blank = if choice.is_multiple_of(5) { "" } else { " " };
            tokens[place] = format!("\"{number}{blank}{}\"", UNITS[choice % UNITS.len()]).into();
        }
        Change::Word => {
            let word = one_of(WORDS, choice);
            tokens[place] = if token.starts_with('"') { format!("\"{word}\"").into() } else { word.into() };
        }
        Change::Nest => {
            let depth = [2, 40, 100, 3000][choice % 4];
            let (open, close) = if choice.is_multiple_of(3) { ("{a=", "}") } else { ("[", "]") };
            tokens[place] = format!("{}1{}", open.repeat(depth), close.repeat(depth)).into();
        }
        Change::Array => {
            let count = [0, 1, 2, 3, 1000, 10_000, 10_001][choice % 7];
            let numbers: Vec<String> = (0..count).map(|i| format!("{}", i as f64 * 1e-3)).collect();
            tokens[place] = format!("[{}]", numbers.join(",")).into();
        }
        Change::Insert => {
            let at = (0..=token.len())
                .rev()
                .find(|&i| i <= choice % (token.len() + 1) && token.is_char_boundary(i));
            tokens[place].to_mut().insert_str(at.unwrap_or(0), INSERTIONS[choice / 7 % INSERTIONS.len()]);
        }
        Change::Drop => {
            tokens.remove(place);
        }
        Change::Repeat => tokens[place] = token.repeat([2, 3, 500][choice % 3]).into(),
        Change::Swap => {
            let other = suitable(tokens, change, choice % tokens.len());
            tokens.swap(place, other);
        }
        Change::DropLine => drop(tokens.drain(line(tokens, place))),
        Change::RepeatLine => {
            let range = line(tokens, place);
            let copy = tokens[range.clone()].to_vec();
            tokens.splice(range.end..range.end, copy);
        }
        Change::Flip => {
            let mut bytes = token.into_owned().into_bytes();
            let at = choice % bytes.len();
            bytes[at] ^= 1 << (choice / 64 % 8);
            tokens[place] = String::from_utf8_lossy(&bytes).into_owned().into();
        }
        Change::Truncate => tokens.truncate(place),
    }
}

/// A word of a list, counted round.
fn one_of(words: &'static str, choice: usize) -> &'static str {
    let count = words.split(' ').count();
    words.split(' ').nth(choice % count).unwrap()
}

/// Number and unit of a quoted quantity.
fn quantity(token: &str) -> Option<(&str, &str)> {
    let inner = token.strip_prefix('"')?.strip_suffix('"')?;
    let end = inner.find(|c: char| !(c.is_ascii_digit() || ".+-".contains(c))).unwrap_or(inner.len());
    inner.starts_with(|c: char| c.is_ascii_digit() || c == '-').then(|| inner.split_at(end))
}

/// The tokens of the line that a token is in.
fn line(tokens: &[Cow<'_, str>], place: usize) -> std::ops::Range<usize> {
    let start = tokens[..place].iter().rposition(|token| token == "\n").map_or(0, |i| i + 1);
    let end = tokens[place..].iter().position(|token| token == "\n").map_or(tokens.len(), |i| place + i + 1);
    start..end
}

/// Words and numbers, quoted texts, comments, blanks, and everything else by itself; together they are the
/// text.
fn tokens(text: &str) -> Vec<&str> {
    let mut tokens = Vec::new();
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let run = |belongs: &dyn Fn(char) -> bool| rest.find(|c: char| !belongs(c)).unwrap_or(rest.len());
        let end = match first {
            '\n' => 1,
            '"' | '\'' => rest[1..].find([first, '\n']).map_or(rest.len(), |i| i + 2),
            '#' => run(&|c| c != '\n'),
            c if c.is_whitespace() => run(&|c| c.is_whitespace() && c != '\n'),
            c if is_word(c) => run(&is_word),
            c => c.len_utf8(),
        };
        let (token, remaining) = rest.split_at(end);
        tokens.push(token);
        rest = remaining;
    }
    tokens
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || "_+-.:".contains(c)
}
