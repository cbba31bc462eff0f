//! Rational filters: each output is a sum of inputs through polynomials in the delay, over one polynomial of its own.

use pulp::{Arch, Simd, WithSimd};

/// Rows that one recursion carries side by side: it waits for its own last value, and other rows fill the wait.
const LANES: usize = 8;
/// Coefficients of a polynomial, at most.
const TAPS: usize = 4;
/// Samples that are turned at once, so that the rows of one moment lie together.
const STRETCH: usize = 64;

/// Answers of `rows` outputs to `inputs`, all at rest before the first sample.
///
/// `a_0 y_t = sum_i sum_k b_ik x_i(t-k) - sum_k a_k y_(t-k)` with `a_0 = 1`.
///
/// - `inputs`: signals of `n` samples each.
/// - `numerators`: `b`, shape (rows, inputs, taps).
/// - `denominators`: `a`, shape (rows, taps).
/// - `out`: shape (rows, n); every entry is written.
///
/// # Panics
/// Lengths that do not fit each other, or a recursion of an order above 3.
pub fn respond(inputs: &[&[f64]], numerators: &[f64], denominators: &[f64], taps: usize, n: usize, out: &mut [f64]) {
    let rows = denominators.len() / taps.max(1);
    assert!((1..=TAPS).contains(&taps), "a recursion of order 0 to 3 is needed");
    assert!(inputs.iter().all(|x| x.len() == n) && out.len() == rows * n, "signals of one length are needed");
    assert_eq!(numerators.len(), rows * inputs.len() * taps, "a numerator for each output and input is needed");
    if n == 0 {
        return;
    }
    // Most causes leave some inputs alone.
    let active: Vec<bool> = inputs.iter().map(|x| x.iter().any(|&v| v != 0.0)).collect();
    let mut moved = vec![false; rows];
    for (r, row) in out.chunks_exact_mut(n).enumerate() {
        row.fill(0.0);
        for (i, x) in inputs.iter().enumerate() {
            let b = &numerators[(r * inputs.len() + i) * taps..][..taps];
            if active[i] && b.iter().any(|&v| v != 0.0) {
                Arch::new().dispatch(Add { b, x, row });
                moved[r] = true;
            }
        }
    }
    // Rows that nothing moves stay at rest.
    let mut bundle: Vec<(&mut [f64], [f64; 3])> = out
        .chunks_exact_mut(n)
        .zip(&moved)
        .enumerate()
        .filter(|(_, (_, m))| **m)
        .map(|(r, (row, _))| {
            let mut a = [0.0; 3];
            a[..taps - 1].copy_from_slice(&denominators[r * taps + 1..(r + 1) * taps]);
            (row, a)
        })
        .collect();
    for part in bundle.chunks_mut(LANES) {
        if part.len() <= LANES / 2 {
            Arch::new().dispatch(Recur::<{ LANES / 2 }> { rows: part, n });
        } else {
            Arch::new().dispatch(Recur::<LANES> { rows: part, n });
        }
    }
}

/// Adds an input through a polynomial in the delay; compiled for each width of vectors.
struct Add<'a> {
    b: &'a [f64],
    x: &'a [f64],
    row: &'a mut [f64],
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
    fn with_simd<S: Simd>(self, _: S) {
        // All taps in one pass, each sum in the order of its taps.
        let mut b = [0.0; TAPS];
        b[..self.b.len()].copy_from_slice(self.b);
        let (x, n) = (self.x, self.x.len());
        for t in 0..n.min(TAPS - 1) {
            for k in 0..=t {
                self.row[t] += b[k] * x[t - k];
            }
        }
        if n < TAPS {
            return;
        }
        let past = x[2..n - 1].iter().zip(&x[1..n - 2]).zip(&x[..n - 3]);
        for ((y, &now), ((&one, &two), &three)) in self.row[3..].iter_mut().zip(&x[3..]).zip(past) {
            *y = *y + b[0] * now + b[1] * one + b[2] * two + b[3] * three;
        }
    }
}

/// The denominators of rows side by side; compiled for each width of vectors.
struct Recur<'a, 'b, const L: usize> {
    rows: &'a mut [(&'b mut [f64], [f64; 3])],
    n: usize,
}

impl<const L: usize> WithSimd for Recur<'_, '_, L> {
    type Output = ();

    #[inline(always)]
    #[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
    fn with_simd<S: Simd>(self, _: S) {
        recur::<L>(self.rows, self.n);
    }
}

/// The denominators, for up to `L` rows side by side.
#[inline(always)]
#[expect(clippy::inline_always, reason = "it is compiled for the vectors of its caller")]
fn recur<const L: usize>(rows: &mut [(&mut [f64], [f64; 3])], n: usize) {
    let mut a = [[0.0; L]; 3];
    for (l, (_, own)) in rows.iter().enumerate() {
        for k in 0..3 {
            a[k][l] = own[k];
        }
    }
    let mut past = [[0.0; L]; 3];
    let mut turned = [[0.0; L]; STRETCH];
    let mut start = 0;
    while start < n {
        let count = STRETCH.min(n - start);
        for (l, (row, _)) in rows.iter().enumerate() {
            for (t, &w) in row[start..start + count].iter().enumerate() {
                turned[t][l] = w;
            }
        }
        for now in &mut turned[..count] {
            for l in 0..L {
                // The newest value last: the others are ready before it is.
                now[l] = now[l] - a[2][l] * past[2][l] - a[1][l] * past[1][l] - a[0][l] * past[0][l];
            }
            past = [*now, past[0], past[1]];
        }
        for (l, (row, _)) in rows.iter_mut().enumerate() {
            for (t, y) in row[start..start + count].iter_mut().enumerate() {
                *y = turned[t][l];
            }
        }
        start += count;
    }
}
