//! A text as numbers, names and symbols.

use super::error::ExpressionError;
use super::words::CASES;
use std::ops::Range;
use stickslip_text::excerpt::short;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum TokenKind {
    Number(f64),
    Name,
    Symbol(char),
    End,
}

#[derive(Clone, Debug)]
pub(super) struct Token {
    pub kind: TokenKind,
    pub place: Range<usize>,
}

const SYMBOLS: &str = "+-*/^(),";

/// Characters that users type instead of others.
const MISTAKEN: [(&str, &str); 8] = [
    ("'’′\u{307}ẋ", "xdot"),
    ("×·⋅∙", "*"),
    ("−–—", "-"),
    ("÷", "/"),
    ("²", "^2"),
    ("³", "^3"),
    ("π", "pi"),
    ("=<>≤≥≠?:&|!", CASES),
];

/// The tokens of a text. An `End` is the last of them.
pub(super) fn tokens(text: &str) -> Result<Vec<Token>, ExpressionError> {
    let mut all: Vec<Token> = Vec::new();
    let mut at = 0;
    while let Some(c) = text[at..].chars().next() {
        let length =
            |is_part: fn(char) -> bool| text[at..].find(|c| !is_part(c)).unwrap_or(text.len() - at);
        let is_number = c.is_ascii_digit()
            || (c == '.' && text[at + 1..].starts_with(|c: char| c.is_ascii_digit()));
        let (kind, end) = if c.is_whitespace() {
            at += c.len_utf8();
            continue;
        } else if is_number {
            let end = at + number_length(&text[at..]);
            let run = at + length(|c| c.is_ascii_alphanumeric() || c == '_' || c == '.');
            if is_no_number(&text[at..end], &text[end..run.max(end)]) {
                let remedy = "write digits, a point and an exponent, as in 1000, 0.5 or 1e-3";
                let problem = format!("`{}` is not a number", short(&text[at..run]));
                return Err(ExpressionError::new(at..run, problem, remedy));
            }
            (TokenKind::Number(number(&text[at..end], at)?), end)
        } else if c.is_ascii_alphabetic() || c == '_' {
            (
                TokenKind::Name,
                at + length(|c| c.is_ascii_alphanumeric() || c == '_'),
            )
        } else if text[at..].starts_with("**") {
            let remedy = "write `^` for a power";
            return Err(ExpressionError::new(
                at..at + 2,
                "`**` is not an operator",
                remedy,
            ));
        } else if SYMBOLS.contains(c) {
            (TokenKind::Symbol(c), at + c.len_utf8())
        } else {
            return Err(unexpected(text, c, at, all.last()));
        };
        all.push(Token {
            kind,
            place: at..end,
        });
        at = end;
    }
    all.push(Token {
        kind: TokenKind::End,
        place: text.len()..text.len(),
    });
    Ok(all)
}

/// The length of the number that begins the text: digits, a point, and an exponent if it has
/// digits.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| {
        bytes[from..]
            .iter()
            .take_while(|byte| byte.is_ascii_digit())
            .count()
    };
    let mut length = digits(0);
    if bytes.get(length) == Some(&b'.') {
        length += 1 + digits(length + 1);
    }
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let exponent = digits((length + 1 + sign).min(bytes.len()));
        length += if exponent > 0 { 1 + sign + exponent } else { 0 };
    }
    length
}

/// Whether the letters, digits, points and underscores that follow a number were meant to belong to
/// it, as in 1.2.3, 1_000, 0x10 and 1e.
fn is_no_number(number: &str, rest: &str) -> bool {
    let has_digit = |prefix: char| {
        rest.strip_prefix(prefix)
            .is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    rest.starts_with(['.', '_']) || matches!(rest, "e" | "E") || (number == "0" && has_digit('x'))
}

fn number(text: &str, at: usize) -> Result<f64, ExpressionError> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| {
        let problem = "the number is too large";
        ExpressionError::new(
            at..at + text.len(),
            problem,
            format!("write a number below {:.1e}", f64::MAX),
        )
    })
}

fn unexpected(text: &str, c: char, at: usize, last: Option<&Token>) -> ExpressionError {
    let mut place = at..at + c.len_utf8();
    let right = MISTAKEN
        .iter()
        .find(|(wrong, _)| wrong.contains(c))
        .map(|(_, right)| *right);
    // A prime belongs to the name before it.
    if right == Some("xdot")
        && let Some(name) = last.filter(|last| last.kind == TokenKind::Name && last.place.end == at)
    {
        place.start = name.place.start;
    }
    let remedy = match right {
        Some("xdot") => "write `xdot` for the velocity".into(),
        Some(CASES) => format!("comparisons are not supported: {CASES}"),
        Some(right) => format!("write `{right}`"),
        None => {
            "use numbers, names (letters a to z, digits and _), the operators + - * / ^, parentheses and commas".into()
        }
    };
    let problem = format!(
        "unexpected `{}` in an expression",
        short(&text[place.clone()])
    );
    ExpressionError::new(place, problem, remedy)
}
