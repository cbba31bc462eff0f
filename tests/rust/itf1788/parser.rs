//! Reads `.itl` files as data: comments, test cases, statements `operation operands = results signal X;`.

use interval_core::exact::{from_text, ratio_down, ratio_up, rational};
use interval_core::{DecoratedInterval, Decoration, Interval};
use num_bigint::BigInt;

/// One operand or result.
#[derive(Debug, Clone)]
pub enum Value {
    Bare(Interval),
    Decorated(DecoratedInterval),
    Number(f64),
    Vector(Vec<f64>),
    Text(String),
    Word(String),
}

#[derive(Debug)]
pub struct Statement {
    pub line: usize,
    pub operation: String,
    pub operands: Vec<Value>,
    pub results: Vec<Value>,
    pub signal: Option<String>,
}

/// Comments become blanks, so that lines keep their numbers; text in quotes is left alone.
fn without_comments(source: &str) -> String {
    let mut kept = String::with_capacity(source.len());
    let mut rest = source;
    while let Some(c) = rest.chars().next() {
        let cut = if rest.starts_with("/*") {
            let end = rest.find("*/").map_or(rest.len(), |at| at + 2);
            kept.extend(rest[..end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }));
            end
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c == '"' {
            let end = rest[1..].find('"').map_or(rest.len(), |at| at + 2);
            kept.push_str(&rest[..end]);
            end
        } else {
            kept.push(c);
            c.len_utf8()
        };
        rest = &rest[cut..];
    }
    kept
}

/// Cuts a statement into quoted texts, bracketed intervals with their suffix, braced vectors, and words.
fn tokens(text: &str) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while let Some(c) = rest.chars().next() {
        let length = match c {
            '=' => 1,
            '"' => rest[1..].find('"').ok_or("a quote is not closed")? + 2,
            '{' => rest.find('}').ok_or("a brace is not closed")? + 1,
            '[' => {
                let close = rest.find(']').ok_or("a bracket is not closed")? + 1;
                close + rest[close..].find(|c: char| !(c == '_' || c.is_alphanumeric())).unwrap_or(rest.len() - close)
            }
            _ => rest.find(|c: char| c.is_whitespace() || c == '=').unwrap_or(rest.len()),
        };
        found.push(rest[..length].to_string());
        rest = rest[length..].trim_start();
    }
    Ok(found)
}

/// A binary64 number: decimals and hexadecimals are decoded to the nearest double, not enclosed.
pub fn number(text: &str) -> Option<f64> {
    match text.trim().trim_start_matches('+').to_ascii_lowercase().as_str() {
        "infinity" | "inf" => return Some(f64::INFINITY),
        "-infinity" | "-inf" => return Some(f64::NEG_INFINITY),
        "nan" => return Some(f64::NAN),
        _ => {}
    }
    let exact = from_text(text.trim())?;
    let (down, up) = (ratio_down(&exact), ratio_up(&exact));
    if down == up || !down.is_finite() || !up.is_finite() {
        return if down == up { Some(down) } else { text.trim().parse().ok() };
    }
    let middle = (rational(down) + rational(up)) / BigInt::from(2);
    // The middle goes to the double whose last bit is 0.
    let low = exact < middle || (exact == middle && down.to_bits() % 2 == 0);
    Some(if low { down } else { up })
}

fn interval(text: &str) -> Option<Interval> {
    let inner = text.strip_prefix('[')?.strip_suffix(']')?.trim();
    match inner.to_ascii_lowercase().as_str() {
        "empty" => return Some(Interval::EMPTY),
        "entire" => return Some(Interval::ENTIRE),
        _ => {}
    }
    let (lower, upper) = inner.split_once(',').unwrap_or((inner, inner));
    Interval::new(number(lower)?, number(upper)?).ok()
}

fn value(token: &str) -> Result<Value, String> {
    let refusal = || format!("'{token}' is not understood");
    if let Some(text) = token.strip_prefix('"') {
        return Ok(Value::Text(text.trim_end_matches('"').to_string()));
    }
    if let Some(inner) = token.strip_prefix('{') {
        let entries = inner.trim_end_matches('}').split(',').map(number);
        return entries.collect::<Option<_>>().map(Value::Vector).ok_or_else(refusal);
    }
    if token.starts_with('[') {
        let close = token.find(']').ok_or_else(refusal)? + 1;
        if token[1..close - 1].trim().eq_ignore_ascii_case("nai") {
            return Ok(Value::Decorated(DecoratedInterval::NAI));
        }
        let bare = interval(&token[..close]).ok_or_else(refusal)?;
        let Some(name) = token[close..].strip_prefix('_') else { return Ok(Value::Bare(bare)) };
        let decoration: Decoration = name.parse().map_err(|_| refusal())?;
        let decorated = DecoratedInterval::new(bare, decoration);
        // An expectation that no decorated interval can have must not be weakened into one.
        return if decorated.decoration() == decoration { Ok(Value::Decorated(decorated)) } else { Err(refusal()) };
    }
    if let Some(x) = number(token) { Ok(Value::Number(x)) } else { Ok(Value::Word(token.to_string())) }
}

fn statement(text: &str, line: usize) -> Result<Statement, String> {
    let tokens = tokens(text)?;
    let equals = tokens.iter().position(|t| t == "=").ok_or("there is no '='")?;
    let (left, right) = (&tokens[..equals], &tokens[equals + 1..]);
    let (operation, operands) = left.split_first().ok_or("there is no operation")?;
    let at = right.iter().position(|t| t == "signal").unwrap_or(right.len());
    Ok(Statement {
        line,
        operation: operation.clone(),
        operands: operands.iter().map(|t| value(t)).collect::<Result<_, _>>()?,
        results: right[..at].iter().map(|t| value(t)).collect::<Result<_, _>>()?,
        signal: right.get(at + 1).cloned(),
    })
}

/// The position of the first of `targets` outside quotes.
fn outside_quotes(text: &str, targets: &[char]) -> Option<usize> {
    let mut quoted = false;
    text.char_indices().find_map(|(at, c)| {
        quoted ^= c == '"';
        (!quoted && targets.contains(&c)).then_some(at)
    })
}

/// All statements of a file, and what could not be read, with its line.
pub fn statements(source: &str) -> Vec<Result<Statement, (usize, String)>> {
    let text = without_comments(source);
    let mut found = Vec::new();
    let (mut start, mut inside) = (0, false);
    while start < text.len() {
        let rest = &text[start..];
        if !inside {
            let Some(open) = rest.find('{') else { break };
            (start, inside) = (start + open + 1, true);
            continue;
        }
        let body = rest.trim_start();
        let begin = start + rest.len() - body.len();
        if body.starts_with('}') {
            (start, inside) = (begin + 1, false);
            continue;
        }
        let line = 1 + text[..begin].matches('\n').count();
        let Some(end) = outside_quotes(body, &[';']) else {
            found.push(Err((line, "a statement does not end".to_string())));
            break;
        };
        found.push(statement(&body[..end], line).map_err(|reason| (line, reason)));
        start = begin + end + 1;
    }
    found
}
