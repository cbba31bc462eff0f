//! Conformance with IEEE 1788 by the ITF1788 vectors, read as data from `IVSID_ITF1788` (default
//! ../shared/data/itf1788).
//!
//! Ends with the line `N passed, N failed, N skipped`; shown with `-- --nocapture`.
#![allow(clippy::incompatible_msrv, reason = "the oldest compiler is that of the crates alone")]
#![allow(clippy::print_stdout, reason = "the summary is what the harness is run for")]

#[path = "itf1788/operations.rs"]
mod operations;
#[path = "itf1788/parser.rs"]
mod parser;

use interval_core::{DecoratedInterval, Interval};
use operations::{REVERSE, TRANSCENDENTAL, run};
use parser::{Statement, Value, statements};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Default)]
struct Tally {
    passed: usize,
    /// Of the passed ones, transcendental results that are not the tightest.
    loose: usize,
    /// Of the passed ones, reverse results that are tighter than expected.
    inside: usize,
    failed: Vec<String>,
    /// Reason and count.
    skipped: BTreeMap<String, usize>,
}

/// The distance that a result may have from the expectation.
#[derive(Clone, Copy, PartialEq)]
enum Slack {
    /// Not at all.
    None,
    /// One ulp a side outside it.
    Outside,
    /// One ulp a side outside it, or up to two inside: some expectations of reverse functions are not the tightest
    /// intervals, which these results are (`tests/rust/reverse.rs`).
    Around,
}

/// True if `given` is `expected` within `slack`.
fn encloses(given: Interval, expected: Interval, slack: Slack) -> bool {
    if slack == Slack::None || given.is_empty() || expected.is_empty() {
        return given == expected;
    }
    let near = |outer: f64, e: f64| {
        let inside = [e.next_up(), e.next_up().next_up()];
        outer == e || outer == e.next_down() || (slack == Slack::Around && inside.contains(&outer))
    };
    near(given.lo(), expected.lo()) && near(-given.hi(), -expected.hi())
}

/// Two expectations of `pow_rev.itl` are far wider than the set they stand for: b^t >= 2 for a b in [1/4, 1/2] or [1/4,
/// 1] holds only for t <= -1/2. They are named, and the result is held against that set.
fn corrected(operation: &str, operands: &[Value]) -> Option<Interval> {
    let [Value::Bare(b), Value::Bare(c), Value::Bare(x)] = operands else { return None };
    let known = operation == "powRev2"
        && b.lo() == 0.25
        && (b.hi() == 0.5 || b.hi() == 1.0)
        && (c.lo(), c.hi()) == (2.0, f64::INFINITY)
        && x.is_entire();
    if known { Interval::new(f64::NEG_INFINITY, -0.5).ok() } else { None }
}

fn agree(given: &Value, expected: &Value, slack: Slack) -> bool {
    match (given, expected) {
        (Value::Bare(g), Value::Bare(e)) => encloses(*g, *e, slack),
        (Value::Decorated(g), Value::Decorated(e)) => same_decorated(*g, *e, slack),
        // A bare expectation of a decorated statement: the empty interval is written without its decoration.
        (Value::Decorated(g), Value::Bare(e)) => g.interval().is_some_and(|g| encloses(g, *e, slack)),
        (Value::Number(g), Value::Number(e)) => g == e || (g.is_nan() && e.is_nan()),
        (Value::Word(g), Value::Word(e)) => g == e,
        _ => false,
    }
}

fn same_decorated(given: DecoratedInterval, expected: DecoratedInterval, slack: Slack) -> bool {
    given.decoration() == expected.decoration()
        && match (given.interval(), expected.interval()) {
            (Some(g), Some(e)) => encloses(g, e, slack),
            (None, None) => true,
            _ => false,
        }
}

fn judge(file: &str, statement: &Statement, tally: &mut Tally) {
    let place = format!("{file}:{} {}", statement.line, statement.operation);
    let Some(outcome) = run(statement) else {
        *tally.skipped.entry(format!("operation {} is not provided", statement.operation)).or_default() += 1;
        return;
    };
    let slack = match statement.operation.as_str() {
        name if REVERSE.contains(&name) => Slack::Around,
        name if TRANSCENDENTAL.contains(&name) => Slack::Outside,
        _ => Slack::None,
    };
    let mut expected = statement.results.clone();
    if let Some(tightest) = corrected(&statement.operation, &statement.operands) {
        println!("{place}: expects {expected:?}, the tightest interval is {tightest}");
        // Only the known expectation is corrected; any other fails.
        let known = Interval::new(f64::NEG_INFINITY, f64::INFINITY)
            .ok()
            .into_iter()
            .chain(Interval::new(f64::NEG_INFINITY, 0.0));
        if known.into_iter().any(|k| matches!(expected.as_slice(), [Value::Bare(e)] if *e == k)) {
            expected = vec![Value::Bare(tightest)];
        }
    }
    let all = |slack: Slack| {
        outcome.values.len() == expected.len() && outcome.values.iter().zip(&expected).all(|(g, e)| agree(g, e, slack))
    };
    let signals = statement.signal.as_deref() == outcome.signal;
    if !all(slack) || !signals {
        let (given, signal) = (&outcome.values, outcome.signal);
        tally.failed.push(format!(
            "{place}: expected {:?} {:?}, got {given:?} {signal:?}",
            statement.results, statement.signal
        ));
        return;
    }
    tally.passed += 1;
    tally.loose += usize::from(slack == Slack::Outside && !all(Slack::None));
    tally.inside += usize::from(slack == Slack::Around && !all(Slack::Outside));
    if statement.operands.len() == 2 && statement.operation == "midRad" {
        println!("{place}: has one operand too many; the first one was used");
    }
}

fn run_source(file: &str, source: &str, tally: &mut Tally) {
    for statement in statements(source) {
        match statement {
            Ok(statement) => judge(file, &statement, tally),
            Err((line, reason)) => tally.failed.push(format!("{file}:{line}: {reason}")),
        }
    }
}

/// The entries of the folder of vectors; `None` where nobody named one and the usual one is not there.
///
/// # Panics
/// A folder that was asked for cannot be read: a test without its vectors has not passed.
fn vectors(asked: Option<PathBuf>, usual: &Path) -> Option<std::fs::ReadDir> {
    match asked {
        Some(folder) => match std::fs::read_dir(&folder) {
            Ok(entries) => Some(entries),
            Err(error) => panic!("IVSID_ITF1788 = {} cannot be read ({error})", folder.display()),
        },
        None => std::fs::read_dir(usual).ok(),
    }
}

#[test]
#[should_panic(expected = "cannot be read")]
fn vectors_that_are_asked_for_and_missing_fail() {
    vectors(Some(PathBuf::from("/no/such/folder")), Path::new("."));
}

#[test]
fn conformance() {
    let asked = std::env::var_os("IVSID_ITF1788").map(PathBuf::from);
    let usual = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/itf1788");
    let folder = asked.clone().unwrap_or_else(|| usual.clone());
    let Some(entries) = vectors(asked, &usual) else {
        println!("skipped: {} does not exist; set IVSID_ITF1788 to a folder of .itl files", folder.display());
        return;
    };
    let mut files: Vec<PathBuf> = entries.filter_map(|e| e.ok().map(|e| e.path())).collect();
    files.retain(|path| path.extension().is_some_and(|e| e == "itl"));
    files.sort();
    let mut tally = Tally::default();
    for path in &files {
        let source = std::fs::read_to_string(path).expect("a readable file");
        run_source(&path.file_name().unwrap_or_default().to_string_lossy(), &source, &mut tally);
    }
    for failure in &tally.failed {
        println!("FAILED {failure}");
    }
    for (reason, count) in &tally.skipped {
        println!("skipped {count}: {reason}");
    }
    println!("{} transcendental results are one ulp wider than expected", tally.loose);
    println!("{} results of reverse functions are one or two ulps tighter than expected", tally.inside);
    let skipped: usize = tally.skipped.values().sum();
    println!("{} passed, {} failed, {skipped} skipped", tally.passed, tally.failed.len());
    assert!(tally.failed.is_empty());
    assert!(tally.passed > 0, "no statement was found in {}", folder.display());
}

fn tally(source: &str) -> Tally {
    let mut tally = Tally::default();
    run_source("text", source, &mut tally);
    tally
}

#[test]
fn a_corrupted_expectation_fails() {
    let right = "testcase t { /* a; b */ add [1.0, 2.0] [3.0, 4.0] = [4.0, 6.0]; exp [0.0] = [1.0, 1.0]; // c;\n }";
    assert_eq!((tally(right).passed, tally(right).failed.len()), (2, 0));
    for wrong in [
        "testcase t { add [1.0, 2.0] [3.0, 4.0] = [4.0, 0x1.8000000000001p2]; }",
        "testcase t { add [1.0, 2.0]_com [3.0, 4.0]_com = [4.0, 6.0]_dac; }",
        "testcase t { exp [1.0, 1.0] = [2.718281828459046, 2.7182818284590455]; }",
        "testcase t { exp [1.0, 1.0] = [2.7182818284590446, 2.7182818284590446]; }",
        "testcase t { overlap [1.0, 2.0] [3.0, 4.0] = after; }",
        "testcase t { mid [1.0, 2.0] = 1.25; }",
        "testcase t { b-textToInterval \"[1, 2\" = [empty]; }",
        "testcase t { isEmpty [empty] = false; }",
        "testcase t { mulRevToPair [-1.0, 1.0] [1.0, 2.0] = [-infinity, -1.0] [1.5, infinity]; }",
        "testcase t { dot_nearest {1.0, 2.0} {3.0, 4.0} = 12.0; }",
        "testcase t { add [1.0, 2.0] [3.0, 4.0] [4.0, 6.0]; }",
        "testcase t { add [1.0, 2.0] [3.0, 4.0] = [4.0, 6.0] }",
    ] {
        assert_eq!((tally(wrong).passed, tally(wrong).failed.len()), (0, 1), "{wrong}");
    }
}

#[test]
fn hexadecimal_numbers_of_any_length_and_sign_are_read_to_the_nearest_double() {
    for (text, right) in [
        // The middle of two doubles goes to the one whose last bit is 0.
        ("0x3923456789abcdp-52", f64::from_bits(0x400c_91a2_b3c4_d5e6)),
        ("-0x1.8p1", -3.0),
        ("0x1.00000000000008p0", 1.0),
        ("0x1.00000000000018p0", 1.0 + 2.0 * f64::EPSILON),
        ("-0x1.000000000000081p0", -1.0 - f64::EPSILON),
        ("0x0.8p-1074", 0.0),
    ] {
        assert_eq!(parser::number(text), Some(right), "{text}");
    }
    let right = "testcase t { add [0x3923456789abcdp-52, 0x3923456789abcdp-52] [-0x1p0, -0x1p0] = [0x1.491a2b3c4d5e6p1, 0x1.491a2b3c4d5e6p1]; }";
    assert_eq!(tally(right).failed, Vec::<String>::new());
}

#[test]
fn recommended_functions_are_called_by_the_names_of_the_standard() {
    let source = "testcase t {
        expm1 [0.0, 1.0] = [0.0, 0x1.b7e151628aed3p+0]; exp2m1 [-1.0, 3.0] = [-0.5, 7.0]; exp10m1 [0.0, 2.0] = [0.0, 99.0];
        logp1 [-1.0, 0.0] = [-infinity, 0.0]; log2p1 [1.0, 7.0] = [1.0, 3.0]; log10p1 [9.0, 99.0] = [1.0, 2.0];
        compoundm1 [1.0, 3.0] [0.5, 2.0] = [0x1.a827999fcef32p-2, 15.0]; rootn [-8.0, 27.0] 3 = [-2.0, 3.0]; cbrt [-8.0, 27.0] = [-2.0, 3.0];
        rootn [-8.0, 16.0]_com 4 = [0.0, 2.0]_trv; rSqrt [0.0, 4.0] = [0.5, infinity]; hypot [3.0, 5.0] [4.0, 12.0] = [5.0, 13.0];
        sinPi [0.0, 1.0]_com = [0.0, 1.0]_com; cosPi [0.0, 1.0] = [-1.0, 1.0]; tanPi [-0.25, 0.25] = [-1.0, 1.0];
        asinPi [-1.0, 1.0] = [-0.5, 0.5]; acosPi [-1.0, 1.0] = [0.0, 1.0]; atanPi [-1.0, infinity] = [-0.25, 0.5];
        atan2Pi [1.0, 1.0] [-1.0, 1.0] = [0.25, 0.75]; sec [0.0, 0.0] = [1.0, 1.0]; csc [0.0, 2.0] = [1.0, infinity];
        cot [0.0, 0.0] = [empty]; acot [0.0, infinity] = [0.0, 0x1.921fb54442d19p+0]; sech [0.0, infinity] = [0.0, 1.0];
        csch [-infinity, 0.0] = [-infinity, 0.0]; coth [20.0, infinity] = [1.0, 0x1.0000000000001p+0]; acoth [1.0, infinity] = [0.0, infinity];
        tanPi [0.25, 0.5]_com = [1.0, infinity]_trv; acoth [-1.0, 1.0] = [empty];
    }";
    let found = tally(source);
    assert_eq!((found.failed.as_slice(), found.passed), (&[] as &[String], 29));
    assert!(found.skipped.is_empty());
}

#[test]
fn an_unknown_operation_is_skipped_with_its_name() {
    let unknown = tally("testcase t { asech [2.0, 3.0] = [0.0, 1.0]; }");
    assert_eq!(unknown.skipped.keys().collect::<Vec<_>>(), ["operation asech is not provided"]);
}
