//! The partitioned hull inverse of the paper, literally (section IV.C, eq. 11-13), and the hull over both of its sets.
//!
//! With `delta = Delta / N` the sets are `I = {lo + k delta}` and `S = {hi - k delta}`, `k = 0 .. N - 1` (in the
//! paper's step 2 the printed `n` stands for `N`). Eq. 11 takes the smallest inverse over `I` and the largest over `S`.
//! Entries of the inverse that fall while `A` grows come out improper, and in two dimensions or more both sets lie on
//! one diagonal of the box of matrices, so the result encloses nothing. Its status is never `Enclosed`.
//!
//! Both sets are `A_c - tau Delta` and `A_c + tau Delta` for `tau = j / N`, `j = 1 .. N`. Every member is inverted,
//! several in the lanes of a vector and chunks of them on all threads, and nothing is kept but the extremes. Up to
//! order 3 cofactors and determinant are evaluated as polynomials in `tau` ([`polynomial`]), beyond it members are
//! eliminated ([`elimination`]). The extremes do not depend on vectors, threads or chunks, to the bit.

mod elimination;
mod extrema;
mod parts;
mod polynomial;
mod watched;

pub use parts::{Part, published_of_parts, published_part};
pub use watched::Watch;
pub(super) use watched::watched;

use super::{Endpoints, Outcome, UNBOUNDED, Value};
use crate::certified::Unproved;
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::names::named;
use crate::parallel;
use crate::rounding::slices::Backend;
use crate::status::Status;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

/// The number N of partitions if the caller names no other: a bound of the time.
pub const DEFAULT_PARTITIONS: u64 = 1000;

/// The largest order of the sweep, whose elimination keeps one member in cache.
pub const ORDER_LIMIT: usize = 64;

/// The choice of extremes from the two sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Eq. 11 as printed: the least over `I` and the largest over `S`; improper entries are kept.
    Literal,
    /// The hull over both sets: proper, but still along one diagonal of the box only.
    Hull,
}

named! {
    /// The way in which the extremes are found.
    Sweep, "sweep" {
        /// Every member of both sets is inverted.
        Members => "members",
        /// Only those at the ends and beside the stationary points of each entry, a rational function of one number.
        Extrema => "extrema",
    }
}

/// Watches a sweep from another thread, and stops it.
#[derive(Debug, Default)]
pub struct Monitor {
    stop: AtomicBool,
    done: AtomicU64,
}

impl Monitor {
    /// Asks the sweep to end; it does within some milliseconds.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Partitions that are done.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

/// Eq. 11 as printed, by inverting every member.
///
/// # Errors
/// A matrix that is not square, or `partitions` of 0.
pub fn published(a: &IntervalMatrix, partitions: u64) -> Result<Outcome, Error> {
    published_with(a, partitions, (Form::Literal, Sweep::Members), Backend::chosen(), &Monitor::default())
}

/// The hull over both sets, by inverting every member.
///
/// # Errors
/// A matrix that is not square, or `partitions` of 0.
pub fn published_hull(a: &IntervalMatrix, partitions: u64) -> Result<Outcome, Error> {
    published_with(a, partitions, (Form::Hull, Sweep::Members), Backend::chosen(), &Monitor::default())
}

/// Either form by either sweep on a back end of the caller's choice, watched by a monitor.
///
/// # Errors
/// A matrix that is not square, or `partitions` of 0.
pub fn published_with(
    a: &IntervalMatrix,
    partitions: u64,
    (form, sweep): (Form, Sweep),
    backend: Backend,
    monitor: &Monitor,
) -> Result<Outcome, Error> {
    if let Some(outcome) = refused(a, partitions)? {
        return Ok(outcome);
    }
    let members = Members::new(a, partitions, backend);
    let extremes = match sweep {
        Sweep::Members => members.sweep(form, 0..partitions, monitor),
        Sweep::Extrema => extrema::find(&members, form),
    };
    Ok(match extremes {
        Some(_) | None if monitor.stopped() => Outcome::without_value(
            Status::NotProved,
            None,
            format!("stopped after {} of {partitions} partitions", monitor.done()),
        ),
        Some(extremes) => not_an_enclosure(extremes.ends(form)),
        None => singular(),
    })
}

/// The outcome of a matrix that cannot be swept.
fn refused(a: &IntervalMatrix, partitions: u64) -> Result<Option<Outcome>, Error> {
    let n = a.order()?;
    if partitions == 0 {
        return Err(Error::Zero { what: "the number of partitions" });
    }
    if n > ORDER_LIMIT {
        return Ok(Some(Outcome::not_applicable(format!("order {n} exceeds {ORDER_LIMIT}, the limit of the sweep"))));
    }
    Ok((!a.is_bounded()).then(|| Outcome::not_applicable(UNBOUNDED)))
}

fn singular() -> Outcome {
    Outcome::not_applicable("a matrix of the sweep is singular or its inverse overflows")
}

fn not_an_enclosure(value: Endpoints) -> Outcome {
    let improper = value.improper().iter().filter(|&&x| x).count();
    let reason = format!(
        "the sweep follows one diagonal of the box of matrices, so its result is not an enclosure; {improper} of {} \
         entries are improper",
        value.lower.len()
    );
    let value = Some(Value::Unproved(Unproved(value)));
    Outcome { status: Status::NotProved, value, certificate: None, gap: None, reason: Some(reason) }
}

/// Extremes of the inverses over each set, row-major. For the literal form only `infima.lower` and `suprema.upper` are
/// found.
#[derive(Debug, Clone)]
struct Extremes {
    infima: Endpoints,
    suprema: Endpoints,
}

impl Extremes {
    fn none(entries: usize) -> Self {
        let none = Endpoints { lower: vec![f64::INFINITY; entries], upper: vec![f64::NEG_INFINITY; entries] };
        Self { infima: none.clone(), suprema: none }
    }

    fn merge(mut self, other: &Self) -> Self {
        for (a, b) in [(&mut self.infima, &other.infima), (&mut self.suprema, &other.suprema)] {
            a.lower.iter_mut().zip(&b.lower).for_each(|(x, &y)| *x = x.min(y));
            a.upper.iter_mut().zip(&b.upper).for_each(|(x, &y)| *x = x.max(y));
        }
        self
    }

    /// Zeros are positive: which of two zeros a minimum keeps depends on the processor.
    fn ends(self, form: Form) -> Endpoints {
        let plain = |x: f64| x + 0.0;
        let pair = |f: fn(f64, f64) -> f64, x: Vec<f64>, y: Vec<f64>| -> Vec<f64> {
            x.into_iter().zip(y).map(|(x, y)| plain(f(x, y))).collect()
        };
        match form {
            Form::Literal => Endpoints {
                lower: self.infima.lower.into_iter().map(plain).collect(),
                upper: self.suprema.upper.into_iter().map(plain).collect(),
            },
            Form::Hull => Endpoints {
                lower: pair(f64::min, self.infima.lower, self.suprema.lower),
                upper: pair(f64::max, self.infima.upper, self.suprema.upper),
            },
        }
    }
}

/// The two sets, ready to be inverted.
struct Members<'a> {
    a: &'a IntervalMatrix,
    partitions: u64,
    backend: Backend,
    kernel: Kernel,
}

enum Kernel {
    Polynomial(polynomial::Coefficients),
    Elimination(elimination::Plan),
}

impl<'a> Members<'a> {
    fn new(a: &'a IntervalMatrix, partitions: u64, backend: Backend) -> Self {
        let kernel = match polynomial::Coefficients::new(a) {
            Some(coefficients) => Kernel::Polynomial(coefficients),
            None => Kernel::Elimination(elimination::Plan::new(a, partitions)),
        };
        Self { a, partitions, backend, kernel }
    }

    /// Extremes over the members `k + 1` for `k` in the range; `None` at a singular one, or when the monitor stops.
    fn sweep(&self, form: Form, whole: Range<u64>, monitor: &Monitor) -> Option<Extremes> {
        let n = self.a.rows() as u64;
        // A chunk takes some tenths of a millisecond: enough to hide the cost of a task, short enough to share out and
        // to stop.
        let chunk = (1_000_000 / (n * n * n)).clamp(8, 16_384).next_multiple_of(8);
        let part = |at: u64| {
            if monitor.stopped() {
                return None;
            }
            let first = whole.start + at * chunk;
            let range = first + 1..(first + chunk).min(whole.end) + 1;
            let count = range.end - range.start;
            let found = self.extremes(form, range)?;
            monitor.done.fetch_add(count, Ordering::Relaxed);
            Some(found)
        };
        parallel::try_map_reduce((whole.end - whole.start).div_ceil(chunk), part, |x, y| x.merge(&y))
    }

    /// Extremes over the members `j / N` of both sets for `j` in the range.
    fn extremes(&self, form: Form, range: Range<u64>) -> Option<Extremes> {
        let mut found = Extremes::none(self.a.rows() * self.a.rows());
        let fine = match &self.kernel {
            Kernel::Polynomial(c) => c.extremes(self.backend, self.partitions, form, range, &mut found),
            Kernel::Elimination(plan) => plan.extremes(self.backend, self.a, form, range, &mut found),
        };
        fine.then_some(found)
    }
}
