//! Work shared between threads where there is enough of it. Without the feature `parallel` everything runs on the
//! caller's.

/// Operations below which starting threads costs more than it saves.
#[cfg(all(feature = "linalg", feature = "parallel"))]
const WORTHWHILE: usize = 1 << 18;

/// Whether this process may share work out. A forked copy of a process whose threads had started has none of them, and
/// would wait for them for ever; it works alone.
#[cfg(feature = "parallel")]
fn has_threads() -> bool {
    static STARTED_BY: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    let here = std::process::id();
    *STARTED_BY.get_or_init(|| here) == here
}

/// `work(i, lo, hi)` on every row of `width` entries of two slices; the rows do not depend on each other, so the result
/// does not depend on the number of threads.
#[cfg(feature = "linalg")]
pub(crate) fn rows(
    operations: usize,
    width: usize,
    lo: &mut [f64],
    hi: &mut [f64],
    work: impl Fn(usize, &mut [f64], &mut [f64]) + Sync,
) {
    if width == 0 {
        return;
    }
    #[cfg(feature = "parallel")]
    if operations >= WORTHWHILE && has_threads() {
        use rayon::prelude::*;
        lo.par_chunks_mut(width).zip(hi.par_chunks_mut(width)).enumerate().for_each(|(i, (l, h))| work(i, l, h));
        return;
    }
    let _ = operations;
    lo.chunks_mut(width).zip(hi.chunks_mut(width)).enumerate().for_each(|(i, (l, h))| work(i, l, h));
}

/// `merge` of `map(0)`, `map(1)`, ...; `None` as soon as one of them is, and the rest is left out. The merge is
/// associative and commutative to the bit.
#[cfg(all(feature = "linalg", feature = "parallel"))]
pub(crate) fn try_map_reduce<T: Send>(
    count: u64,
    map: impl Fn(u64) -> Option<T> + Sync + Send,
    merge: impl Fn(T, T) -> T + Sync + Send,
) -> Option<T> {
    use rayon::prelude::*;
    if !has_threads() {
        let first = map(0)?;
        return (1..count).try_fold(first, |sum, i| Some(merge(sum, map(i)?)));
    }
    (0..count).into_par_iter().map(map).try_reduce_with(|x, y| Some(merge(x, y))).flatten()
}

/// `merge` of `map(0)`, `map(1)`, ...; `None` as soon as one of them is.
#[cfg(all(feature = "linalg", not(feature = "parallel")))]
pub(crate) fn try_map_reduce<T>(count: u64, map: impl Fn(u64) -> Option<T>, merge: impl Fn(T, T) -> T) -> Option<T> {
    let first = map(0)?;
    (1..count).try_fold(first, |sum, i| Some(merge(sum, map(i)?)))
}

/// Both, at once where there are threads.
#[cfg(feature = "parallel")]
pub(crate) fn join<A: Send, B: Send>(a: impl FnOnce() -> A + Send, b: impl FnOnce() -> B + Send) -> (A, B) {
    if has_threads() { rayon::join(a, b) } else { (a(), b()) }
}

/// Both, one after the other.
#[cfg(not(feature = "parallel"))]
pub(crate) fn join<A, B>(a: impl FnOnce() -> A, b: impl FnOnce() -> B) -> (A, B) {
    (a(), b())
}

/// `work(0)`, `work(1)`, ... in this order, shared out where that is worth while.
#[cfg(feature = "linalg")]
pub(crate) fn map<T: Send>(count: usize, worthwhile: bool, work: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    #[cfg(feature = "parallel")]
    if worthwhile && has_threads() {
        use rayon::prelude::*;
        return (0..count).into_par_iter().map(work).collect();
    }
    let _ = worthwhile;
    (0..count).map(work).collect()
}

/// `work(i, a, b)` on every piece of `width` entries of two slices (the last may be shorter), in this order.
#[cfg(feature = "linalg")]
pub(crate) fn chunks<T: Send>(
    width: usize,
    a: &mut [f64],
    b: &mut [f64],
    work: impl Fn(usize, &mut [f64], &mut [f64]) -> T + Sync + Send,
) -> Vec<T> {
    #[cfg(feature = "parallel")]
    if a.len() > width && has_threads() {
        use rayon::prelude::*;
        let pieces = a.par_chunks_mut(width).zip(b.par_chunks_mut(width)).enumerate();
        return pieces.map(|(i, (a, b))| work(i, a, b)).collect();
    }
    a.chunks_mut(width).zip(b.chunks_mut(width)).enumerate().map(|(i, (a, b))| work(i, a, b)).collect()
}

/// `work` on every item, shared out where that is worth while; the items do not depend on each other.
#[cfg(feature = "linalg")]
pub(crate) fn for_each<T: Send>(items: &mut [T], worthwhile: bool, work: impl Fn(&mut T) + Sync + Send) {
    #[cfg(feature = "parallel")]
    if worthwhile && has_threads() {
        use rayon::prelude::*;
        items.par_iter_mut().for_each(work);
        return;
    }
    let _ = worthwhile;
    items.iter_mut().for_each(work);
}
