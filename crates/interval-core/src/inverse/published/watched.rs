//! Long sweeps run on a thread of their own, so that the caller's can report progress and end them.

use super::{Form, Monitor, Outcome, Sweep, published_with};
use crate::error::Error;
use crate::matrix::IntervalMatrix;
use crate::rounding::slices::Backend;
use std::ops::ControlFlow;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Told some times a second how many partitions of a long sweep are done; `Break` ends the sweep.
pub type Watch<'a> = dyn FnMut(u64) -> ControlFlow<()> + 'a;

/// Operations of a sweep that takes some milliseconds, which is too short to be watched.
const SHORT: u64 = 20_000_000;

/// The time between two calls of the caller's function.
const GLANCE: Duration = Duration::from_millis(50);

/// True if a sweep takes long enough to be watched. The search for the extrema alone never does.
const fn is_long(order: usize, partitions: u64, sweep: Sweep) -> bool {
    match sweep {
        Sweep::Members => partitions.saturating_mul((order as u64).saturating_pow(3)) > SHORT,
        Sweep::Extrema => false,
    }
}

/// [`published_with`]. A long sweep that is watched has a thread of its own: `watch` is told the partitions done, and
/// ends it by `Break`.
pub(crate) fn watched(
    a: &IntervalMatrix,
    partitions: u64,
    (form, sweep): (Form, Sweep),
    watch: Option<&mut Watch<'_>>,
) -> Result<Outcome, Error> {
    let monitor = Monitor::default();
    let Some(watch) = watch.filter(|_| is_long(a.rows(), partitions, sweep)) else {
        return published_with(a, partitions, (form, sweep), Backend::chosen(), &monitor);
    };
    let answer = (Mutex::new(None), Condvar::new());
    std::thread::scope(|scope| {
        let (shared, (slot, ready)) = (&monitor, &answer);
        scope.spawn(move || {
            let outcome = published_with(a, partitions, (form, sweep), Backend::chosen(), shared);
            *locked(slot) = Some(outcome);
            ready.notify_one();
        });
        loop {
            let waited = ready.wait_timeout_while(locked(slot), GLANCE, |found| found.is_none());
            let found = waited.unwrap_or_else(PoisonError::into_inner).0.take();
            if let Some(outcome) = found {
                return outcome;
            }
            if watch(shared.done()).is_break() {
                shared.stop();
            }
        }
    })
}

/// The content; a thread that panicked while it held the lock leaves it as it was.
fn locked<T>(slot: &Mutex<T>) -> MutexGuard<'_, T> {
    slot.lock().unwrap_or_else(PoisonError::into_inner)
}
