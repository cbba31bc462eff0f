//! The standard's names and what they are called here.

use super::parser::{Statement, Value};
use interval_core::interval::Overlap;
use interval_core::{DecoratedInterval, Decoration, Interval, reductions};

type Bare1 = fn(Interval) -> Interval;
type Decorated1 = fn(DecoratedInterval) -> DecoratedInterval;
type Bare2 = fn(Interval, Interval) -> Interval;
type Decorated2 = fn(DecoratedInterval, DecoratedInterval) -> DecoratedInterval;

/// The result of a statement: values and the signal, if any.
pub struct Outcome {
    pub values: Vec<Value>,
    pub signal: Option<&'static str>,
}

/// Transcendental operations, for which the standard's tightest interval may be missed by one ulp a side.
pub const TRANSCENDENTAL: [&str; 47] = [
    "exp",
    "exp2",
    "exp10",
    "log",
    "log2",
    "log10",
    "pow",
    "sin",
    "cos",
    "tan",
    "asin",
    "acos",
    "atan",
    "atan2",
    "sinh",
    "cosh",
    "tanh",
    "asinh",
    "acosh",
    "atanh",
    "expm1",
    "exp2m1",
    "exp10m1",
    "logp1",
    "log1p",
    "log2p1",
    "log10p1",
    "compoundm1",
    "rootn",
    "cbrt",
    "rSqrt",
    "hypot",
    "sinPi",
    "cosPi",
    "tanPi",
    "asinPi",
    "acosPi",
    "atanPi",
    "atan2Pi",
    "sec",
    "csc",
    "cot",
    "acot",
    "sech",
    "csch",
    "coth",
    "acoth",
];

/// Their reverses.
pub const REVERSE: [&str; 12] = [
    "sinRev",
    "sinRevBin",
    "cosRev",
    "cosRevBin",
    "tanRev",
    "tanRevBin",
    "coshRev",
    "coshRevBin",
    "pownRev",
    "pownRevBin",
    "powRev1",
    "powRev2",
];

macro_rules! methods {
    ($name:ident) => {
        (Interval::$name, DecoratedInterval::$name)
    };
}

fn one_operand(name: &str) -> Option<(Bare1, Decorated1)> {
    let found: (Bare1, Decorated1) = match name {
        "pos" => (|x| x, |x| x),
        "neg" => (|x| -x, |x| -x),
        "recip" => methods!(recip),
        "sqr" => methods!(square),
        "sqrt" => methods!(sqrt),
        "abs" => methods!(abs),
        "exp" => methods!(exp),
        "exp2" => methods!(exp2),
        "exp10" => methods!(exp10),
        "log" => methods!(ln),
        "log2" => methods!(log2),
        "log10" => methods!(log10),
        "sin" => methods!(sin),
        "cos" => methods!(cos),
        "tan" => methods!(tan),
        "asin" => methods!(asin),
        "acos" => methods!(acos),
        "atan" => methods!(atan),
        "sinh" => methods!(sinh),
        "cosh" => methods!(cosh),
        "tanh" => methods!(tanh),
        "asinh" => methods!(asinh),
        "acosh" => methods!(acosh),
        "atanh" => methods!(atanh),
        "expm1" => methods!(exp_m1),
        "exp2m1" => methods!(exp2_m1),
        "exp10m1" => methods!(exp10_m1),
        "logp1" | "log1p" => methods!(ln_1p),
        "log2p1" => methods!(log2_1p),
        "log10p1" => methods!(log10_1p),
        "cbrt" => methods!(cbrt),
        "rSqrt" => methods!(rsqrt),
        "sinPi" => methods!(sin_pi),
        "cosPi" => methods!(cos_pi),
        "tanPi" => methods!(tan_pi),
        "asinPi" => methods!(asin_pi),
        "acosPi" => methods!(acos_pi),
        "atanPi" => methods!(atan_pi),
        "sec" => methods!(sec),
        "csc" => methods!(csc),
        "cot" => methods!(cot),
        "acot" => methods!(acot),
        "sech" => methods!(sech),
        "csch" => methods!(csch),
        "coth" => methods!(coth),
        "acoth" => methods!(acoth),
        "sign" => methods!(sign),
        "ceil" => methods!(ceil),
        "floor" => methods!(floor),
        "trunc" => methods!(trunc),
        "roundTiesToEven" => methods!(round_ties_even),
        "roundTiesToAway" => methods!(round),
        _ => return None,
    };
    Some(found)
}

fn two_operands(name: &str) -> Option<(Bare2, Decorated2)> {
    let found: (Bare2, Decorated2) = match name {
        "add" => (|x, y| x + y, |x, y| x + y),
        "sub" => (|x, y| x - y, |x, y| x - y),
        "mul" => (|x, y| x * y, |x, y| x * y),
        "div" => (|x, y| x / y, |x, y| x / y),
        "min" => methods!(min),
        "max" => methods!(max),
        "pow" => methods!(pow),
        "atan2" => methods!(atan2),
        "atan2Pi" => methods!(atan2_pi),
        "hypot" => methods!(hypot),
        "compoundm1" => methods!(compound_m1),
        "intersection" => methods!(intersection),
        "convexHull" => methods!(hull),
        "cancelMinus" => methods!(cancel_minus),
        "cancelPlus" => methods!(cancel_plus),
        "sqrRevBin" => methods!(sqr_rev),
        "absRevBin" => methods!(abs_rev),
        "sinRevBin" => methods!(sin_rev),
        "cosRevBin" => methods!(cos_rev),
        "tanRevBin" => methods!(tan_rev),
        "coshRevBin" => methods!(cosh_rev),
        _ => return None,
    };
    Some(found)
}

/// The forms without a range of solutions.
fn reverse(name: &str) -> Option<(Bare2, Decorated2)> {
    two_operands(match name {
        "sqrRev" => "sqrRevBin",
        "absRev" => "absRevBin",
        "sinRev" => "sinRevBin",
        "cosRev" => "cosRevBin",
        "tanRev" => "tanRevBin",
        "coshRev" => "coshRevBin",
        _ => return None,
    })
}

fn relation(name: &str) -> Option<fn(Interval, Interval) -> bool> {
    Some(match name {
        "equal" => |x, y| x == y,
        "subset" => Interval::subset,
        "interior" => Interval::interior,
        "disjoint" => Interval::disjoint,
        "less" => Interval::less,
        "strictLess" => Interval::strict_less,
        "precedes" => Interval::precedes,
        "strictPrecedes" => Interval::strict_precedes,
        _ => return None,
    })
}

fn property(name: &str) -> Option<fn(Interval) -> bool> {
    Some(match name {
        "isEmpty" => Interval::is_empty,
        "isEntire" => Interval::is_entire,
        "isSingleton" => Interval::is_singleton,
        "isCommonInterval" => Interval::is_common,
        _ => return None,
    })
}

fn measure(name: &str) -> Option<fn(Interval) -> f64> {
    Some(match name {
        "inf" => Interval::lo,
        "sup" => Interval::hi,
        "mid" => Interval::midpoint,
        "rad" => Interval::radius,
        "wid" => Interval::width,
        "mag" => Interval::magnitude,
        "mig" => Interval::mignitude,
        _ => return None,
    })
}

fn overlap_name(state: Overlap) -> &'static str {
    match state {
        Overlap::BothEmpty => "bothEmpty",
        Overlap::FirstEmpty => "firstEmpty",
        Overlap::SecondEmpty => "secondEmpty",
        Overlap::Before => "before",
        Overlap::Meets => "meets",
        Overlap::Overlaps => "overlaps",
        Overlap::Starts => "starts",
        Overlap::ContainedBy => "containedBy",
        Overlap::Finishes => "finishes",
        Overlap::Equals => "equals",
        Overlap::FinishedBy => "finishedBy",
        Overlap::Contains => "contains",
        Overlap::StartedBy => "startedBy",
        Overlap::OverlappedBy => "overlappedBy",
        Overlap::MetBy => "metBy",
        Overlap::After => "after",
    }
}

fn word(value: bool) -> Vec<Value> {
    vec![Value::Word(value.to_string())]
}

#[expect(clippy::cast_possible_truncation, reason = "exponents of the tests are integers of 32 bits")]
fn exponent(n: f64) -> i32 {
    n as i32
}

const UNDEFINED: &str = "UndefinedOperation";
const DOUBTFUL: &str = "PossiblyUndefinedOperation";

/// Runs a statement; `None` where the operation or its operands are not known here.
pub fn run(statement: &Statement) -> Option<Outcome> {
    let decorated = statement.operands.iter().chain(&statement.results).any(|v| matches!(v, Value::Decorated(_)));
    let plain = |values| Some(Outcome { values, signal: None });
    let name = statement.operation.as_str();
    match statement.operands.as_slice() {
        [Value::Text(text)] => return constructed_from_text(name, text),
        [Value::Number(lower), Value::Number(upper)] => return constructed(name, *lower, *upper),
        [Value::Vector(x)] => {
            let sum = match name {
                "sum_nearest" => reductions::sum(x),
                "sum_abs_nearest" => reductions::sum_abs(x),
                "sum_sqr_nearest" => reductions::sum_square(x),
                _ => return None,
            };
            return plain(vec![Value::Number(sum)]);
        }
        [Value::Vector(x), Value::Vector(y)] if name == "dot_nearest" => {
            return plain(vec![Value::Number(reductions::dot(x, y))]);
        }
        [x @ (Value::Bare(_) | Value::Decorated(_)), Value::Word(decoration)] if name == "setDec" => {
            let asked: Decoration = decoration.parse().ok()?;
            let result = DecoratedInterval::new(bare(x)?, asked);
            return Some(Outcome {
                values: vec![Value::Decorated(result)],
                signal: (asked == Decoration::Ill).then_some(UNDEFINED),
            });
        }
        [Value::Number(m), x] if name == "isMember" => {
            return plain(word(bare(x).is_some_and(|x| x.contains(*m))));
        }
        _ => {}
    }
    if decorated { run_decorated(name, &statement.operands) } else { run_bare(name, &statement.operands) }
}

fn bare(value: &Value) -> Option<Interval> {
    match value {
        Value::Bare(x) => Some(*x),
        Value::Decorated(x) => x.interval(),
        _ => None,
    }
}

fn constructed_from_text(name: &str, text: &str) -> Option<Outcome> {
    let (value, signal) = match name {
        "b-textToInterval" => match Interval::from_literal(text) {
            Ok((x, doubtful)) => (Value::Bare(x), doubtful.then_some(DOUBTFUL)),
            Err(_) => (Value::Bare(Interval::EMPTY), Some(UNDEFINED)),
        },
        "d-textToInterval" => match DecoratedInterval::from_literal(text) {
            Ok((x, doubtful)) => (Value::Decorated(x), doubtful.then_some(DOUBTFUL)),
            Err(_) => (Value::Decorated(DecoratedInterval::NAI), Some(UNDEFINED)),
        },
        _ => return None,
    };
    Some(Outcome { values: vec![value], signal })
}

fn constructed(name: &str, lower: f64, upper: f64) -> Option<Outcome> {
    let made = Interval::new(lower, upper);
    let signal = made.is_err().then_some(UNDEFINED);
    let value = match name {
        "b-numsToInterval" => Value::Bare(made.unwrap_or(Interval::EMPTY)),
        "d-numsToInterval" => Value::Decorated(made.map_or(DecoratedInterval::NAI, Into::into)),
        _ => return None,
    };
    Some(Outcome { values: vec![value], signal })
}

fn run_bare(name: &str, operands: &[Value]) -> Option<Outcome> {
    let values = match operands {
        [Value::Bare(x)] => {
            let x = *x;
            if let Some((f, _)) = one_operand(name) {
                vec![Value::Bare(f(x))]
            } else if let Some((f, _)) = reverse(name) {
                vec![Value::Bare(f(x, Interval::ENTIRE))]
            } else if let Some(f) = property(name) {
                word(f(x))
            } else if let Some(f) = measure(name) {
                vec![Value::Number(f(x))]
            } else if name == "midRad" {
                vec![Value::Number(x.midpoint()), Value::Number(x.radius())]
            } else if name == "newDec" {
                vec![Value::Decorated(x.into())]
            } else {
                return None;
            }
        }
        [Value::Bare(x), Value::Bare(y)] => {
            let (x, y) = (*x, *y);
            if let Some((f, _)) = two_operands(name) {
                vec![Value::Bare(f(x, y))]
            } else if let Some(f) = relation(name) {
                word(f(x, y))
            } else if name == "overlap" {
                vec![Value::Word(overlap_name(x.overlap(y)).to_string())]
            } else if name == "mulRev" {
                vec![Value::Bare(x.mul_rev(y, Interval::ENTIRE))]
            } else if name == "mulRevToPair" {
                x.mul_rev_to_pair(y).map(Value::Bare).to_vec()
            } else {
                return None;
            }
        }
        [Value::Bare(x), Value::Number(n)] if name == "pown" => vec![Value::Bare(x.powi(exponent(*n)))],
        [Value::Bare(x), Value::Number(n)] if name == "rootn" => vec![Value::Bare(x.rootn(exponent(*n)))],
        [Value::Bare(x), Value::Number(n)] if name == "pownRev" => {
            vec![Value::Bare(x.powi_rev(Interval::ENTIRE, exponent(*n)))]
        }
        [Value::Bare(c), Value::Bare(x), Value::Number(n)] if name == "pownRevBin" => {
            vec![Value::Bare(c.powi_rev(*x, exponent(*n)))]
        }
        [Value::Bare(x), Value::Bare(y), Value::Bare(z)] => vec![Value::Bare(match name {
            "fma" => x.mul_add(*y, *z),
            "mulRev" | "mulRevTen" => x.mul_rev(*y, *z),
            "powRev1" => x.pow_rev_base(*y, *z),
            "powRev2" => x.pow_rev_exponent(*y, *z),
            _ => return None,
        })],
        _ => return None,
    };
    Some(Outcome { values, signal: None })
}

/// An operand of a decorated statement; a bare one carries the strongest decoration.
fn decorate(value: &Value) -> Option<DecoratedInterval> {
    match value {
        Value::Bare(x) => Some((*x).into()),
        Value::Decorated(x) => Some(*x),
        _ => None,
    }
}

fn run_decorated(name: &str, operands: &[Value]) -> Option<Outcome> {
    let entire = DecoratedInterval::from(Interval::ENTIRE);
    let intervals: Vec<DecoratedInterval> = operands.iter().map_while(decorate).collect();
    let rest = &operands[intervals.len()..];
    let mut signal = None;
    let values = match (intervals.as_slice(), rest) {
        ([x], []) => {
            if let Some((_, f)) = one_operand(name) {
                vec![Value::Decorated(f(*x))]
            } else if let Some((_, f)) = reverse(name) {
                vec![Value::Decorated(f(*x, entire))]
            } else if let Some(f) = property(name) {
                word(x.interval().is_some_and(f))
            } else if let Some(f) = measure(name) {
                vec![Value::Number(x.interval().map_or(f64::NAN, f))]
            } else {
                match name {
                    "midRad" => {
                        let x = x.interval().unwrap_or(Interval::EMPTY);
                        vec![Value::Number(x.midpoint()), Value::Number(x.radius())]
                    }
                    "isNaI" => word(x.is_nai()),
                    "intervalPart" => {
                        signal = x.is_nai().then_some("IntvlPartOfNaI");
                        vec![Value::Bare(x.interval().unwrap_or(Interval::EMPTY))]
                    }
                    "decorationPart" => vec![Value::Word(x.decoration().name().to_string())],
                    "newDec" => vec![Value::Decorated(x.interval()?.into())],
                    _ => return None,
                }
            }
        }
        ([x, y], []) => {
            if let Some((_, f)) = two_operands(name) {
                vec![Value::Decorated(f(*x, *y))]
            } else if let Some(f) = relation(name) {
                // Nothing relates to what is not an interval.
                word(matches!((x.interval(), y.interval()), (Some(x), Some(y)) if f(x, y)))
            } else {
                match name {
                    "overlap" => vec![Value::Word(overlap_name(x.overlap(*y)?).to_string())],
                    "mulRev" => vec![Value::Decorated(x.mul_rev(*y, entire))],
                    "mulRevToPair" => x.mul_rev_to_pair(*y).map(Value::Decorated).to_vec(),
                    // libieeep1788_num.itl, line 168: one operand too many, read as the standard means it.
                    "midRad" => return run_decorated(name, &operands[..1]),
                    _ => return None,
                }
            }
        }
        ([x], [Value::Number(n)]) => vec![Value::Decorated(match name {
            "pown" => x.powi(exponent(*n)),
            "rootn" => x.rootn(exponent(*n)),
            "pownRev" => x.powi_rev(entire, exponent(*n)),
            _ => return None,
        })],
        ([c, x], [Value::Number(n)]) if name == "pownRevBin" => {
            vec![Value::Decorated(c.powi_rev(*x, exponent(*n)))]
        }
        ([x, y, z], []) => vec![Value::Decorated(match name {
            "fma" => x.mul_add(*y, *z),
            "mulRev" | "mulRevTen" => x.mul_rev(*y, *z),
            "powRev1" => x.pow_rev_base(*y, *z),
            "powRev2" => x.pow_rev_exponent(*y, *z),
            _ => return None,
        })],
        _ => return None,
    };
    Some(Outcome { values, signal })
}
