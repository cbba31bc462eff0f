//! The operations by name, and the slices they read and write.

use crate::error::Error;
use crate::interval::Interval;
use alloc::vec::Vec;

/// Lower and upper bounds of the intervals of a slice; the empty one is `[inf, -inf]`.
#[derive(Debug, Clone, Copy)]
pub struct Bounds<'a> {
    pub(super) lo: &'a [f64],
    pub(super) hi: &'a [f64],
}

impl<'a> Bounds<'a> {
    /// Bounds of equally many intervals. Their values are looked at by the operation, on the way.
    ///
    /// # Errors
    /// Different lengths.
    pub fn new(lo: &'a [f64], hi: &'a [f64]) -> Result<Self, Error> {
        if lo.len() == hi.len() {
            Ok(Self { lo, hi })
        } else {
            Err(Error::Shape { what: "the upper bound", given: hi.len(), needed: lo.len() })
        }
    }

    /// Number of intervals.
    #[must_use]
    pub fn len(self) -> usize {
        self.lo.len()
    }

    /// True if there are none.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.lo.is_empty()
    }

    /// The intervals one by one.
    ///
    /// # Errors
    /// Bounds that are none: NaN, reversed ones other than the empty interval's, no finite point.
    pub fn intervals(self) -> Result<Vec<Interval>, Error> {
        (0..self.len()).map(|i| self.get(i)).collect()
    }

    pub(super) fn halves(self) -> (Self, Self) {
        let ((a, c), (b, d)) = (self.lo.split_at(self.len() / 2), self.hi.split_at(self.len() / 2));
        (Self { lo: a, hi: b }, Self { lo: c, hi: d })
    }

    /// The interval at `i`.
    ///
    /// # Errors
    /// Bounds that are none: NaN, reversed ones other than the empty interval's, no finite point.
    pub(super) fn get(self, i: usize) -> Result<Interval, Error> {
        let (lo, hi) = (self.lo[i], self.hi[i]);
        if lo == f64::INFINITY && hi == f64::NEG_INFINITY { Ok(Interval::EMPTY) } else { Interval::at(lo, hi, i) }
    }
}

/// The place of results: two slices of the operands' length.
#[derive(Debug)]
pub struct BoundsMut<'a> {
    /// Lower bounds.
    pub lo: &'a mut [f64],
    /// Upper bounds.
    pub hi: &'a mut [f64],
}

impl BoundsMut<'_> {
    /// Number of results there is room for; 0 where the slices differ.
    pub(super) fn len(&self) -> usize {
        if self.lo.len() == self.hi.len() { self.lo.len() } else { 0 }
    }

    pub(super) fn halves(self) -> (Self, Self)
    where
        Self: Sized,
    {
        let middle = self.lo.len() / 2;
        let ((a, c), (b, d)) = (self.lo.split_at_mut(middle), self.hi.split_at_mut(middle));
        (Self { lo: a, hi: b }, Self { lo: c, hi: d })
    }

    pub(super) fn set(&mut self, i: usize, x: Interval) {
        (self.lo[i], self.hi[i]) = (x.lo(), x.hi());
    }
}

// Loops as macros: a closure would be compiled without the features of the function that the loop stands in.
macro_rules! unary_each {
    ($x:ident, $out:ident, $f:expr) => {
        for k in 0..$x.lo.len() {
            $out.set(k, $f($x.get(k)?));
        }
    };
}

macro_rules! binary_each {
    ($operands:ident, $out:ident, $f:expr) => {{
        let (x, y) = $operands;
        for k in 0..x.lo.len() {
            $out.set(k, $f(x.get(k)?, y.get(k)?));
        }
    }};
}

/// Operations by name, each with the function of [`Interval`] that it is.
macro_rules! operations {
    ($(#[$doc:meta])* $kind:ident, $each:ident, $operands:ty, $signature:ty,
     $($name:ident $text:literal => $f:expr,)*) => {
        $(#[$doc])*
        #[non_exhaustive]
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $kind {
            $(#[doc = concat!("`", stringify!($f), "`.")] $name,)*
        }

        impl $kind {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$name,)*];

            /// The name by which [`from_name`](Self::from_name) knows it.
            #[must_use]
            pub fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }

            /// The operation of that name.
            #[must_use]
            pub fn from_name(name: &str) -> Option<Self> {
                match name { $($text => Some(Self::$name),)* _ => None }
            }

            /// True if it is cheap: arithmetic and sets, not elementary functions.
            #[must_use]
            pub fn is_arithmetic(self) -> bool {
                ARITHMETIC.contains(&self.name())
            }

            /// The operation on one interval. Every back end gives the same bits.
            #[must_use]
            pub fn scalar(self) -> $signature {
                match self { $(Self::$name => $f,)* }
            }

            /// One interval after the other, compiled with the features of the caller.
            #[inline(always)]
            pub(super) fn one_by_one(self, operands: $operands, mut out: BoundsMut<'_>) -> Result<(), Error> {
                match self { $(Self::$name => $each!(operands, out, $f),)* }
                Ok(())
            }
        }
    };
}

/// Operations that cost some nanoseconds.
const ARITHMETIC: [&str; 20] = [
    "neg",
    "abs",
    "square",
    "signed_square",
    "sqrt",
    "recip",
    "add",
    "sub",
    "mul",
    "div",
    "min",
    "max",
    "hull",
    "intersection",
    "sign",
    "ceil",
    "floor",
    "trunc",
    "round",
    "round_ties_even",
];

operations! {
    /// Operations of one operand.
    Unary, unary_each, Bounds<'_>, fn(Interval) -> Interval,
    Neg "neg" => |x: Interval| -x,
    Abs "abs" => Interval::abs,
    Square "square" => Interval::square,
    SignedSquare "signed_square" => Interval::signed_square,
    Sqrt "sqrt" => Interval::sqrt,
    Recip "recip" => Interval::recip,
    Exp "exp" => Interval::exp,
    Exp2 "exp2" => Interval::exp2,
    Exp10 "exp10" => Interval::exp10,
    Ln "ln" => Interval::ln,
    Log2 "log2" => Interval::log2,
    Log10 "log10" => Interval::log10,
    Sin "sin" => Interval::sin,
    Cos "cos" => Interval::cos,
    Tan "tan" => Interval::tan,
    Asin "asin" => Interval::asin,
    Acos "acos" => Interval::acos,
    Atan "atan" => Interval::atan,
    Sinh "sinh" => Interval::sinh,
    Cosh "cosh" => Interval::cosh,
    Tanh "tanh" => Interval::tanh,
    Asinh "asinh" => Interval::asinh,
    Acosh "acosh" => Interval::acosh,
    Atanh "atanh" => Interval::atanh,
    ExpM1 "exp_m1" => Interval::exp_m1,
    Exp2M1 "exp2_m1" => Interval::exp2_m1,
    Exp10M1 "exp10_m1" => Interval::exp10_m1,
    Ln1p "ln_1p" => Interval::ln_1p,
    Log2Of1p "log2_1p" => Interval::log2_1p,
    Log10Of1p "log10_1p" => Interval::log10_1p,
    Cbrt "cbrt" => Interval::cbrt,
    Rsqrt "rsqrt" => Interval::rsqrt,
    SinPi "sin_pi" => Interval::sin_pi,
    CosPi "cos_pi" => Interval::cos_pi,
    TanPi "tan_pi" => Interval::tan_pi,
    AsinPi "asin_pi" => Interval::asin_pi,
    AcosPi "acos_pi" => Interval::acos_pi,
    AtanPi "atan_pi" => Interval::atan_pi,
    Sec "sec" => Interval::sec,
    Csc "csc" => Interval::csc,
    Cot "cot" => Interval::cot,
    Acot "acot" => Interval::acot,
    Sech "sech" => Interval::sech,
    Csch "csch" => Interval::csch,
    Coth "coth" => Interval::coth,
    Acoth "acoth" => Interval::acoth,
    Sign "sign" => Interval::sign,
    Ceil "ceil" => Interval::ceil,
    Floor "floor" => Interval::floor,
    Trunc "trunc" => Interval::trunc,
    RoundTiesEven "round_ties_even" => Interval::round_ties_even,
    Round "round" => Interval::round,
}

operations! {
    /// Operations of two operands.
    Binary, binary_each, (Bounds<'_>, Bounds<'_>), fn(Interval, Interval) -> Interval,
    Add "add" => |x: Interval, y: Interval| x + y,
    Sub "sub" => |x: Interval, y: Interval| x - y,
    Mul "mul" => |x: Interval, y: Interval| x * y,
    Div "div" => |x: Interval, y: Interval| x / y,
    Min "min" => Interval::min,
    Max "max" => Interval::max,
    Hull "hull" => Interval::hull,
    Intersection "intersection" => Interval::intersection,
    Pow "pow" => Interval::pow,
    Atan2 "atan2" => Interval::atan2,
    Atan2Pi "atan2_pi" => Interval::atan2_pi,
    Hypot "hypot" => Interval::hypot,
    CompoundM1 "compound_m1" => Interval::compound_m1,
    CancelMinus "cancel_minus" => Interval::cancel_minus,
    CancelPlus "cancel_plus" => Interval::cancel_plus,
}
