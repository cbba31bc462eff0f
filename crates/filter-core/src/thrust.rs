//! Thrust of many demands by a curve of polynomial pieces, with an error of the curve inside its declared accuracy.

/// Demands from which a further thread costs less than it saves.
const WORTHWHILE: usize = 1 << 13;

/// A curve of thrust by demand.
#[derive(Clone, Copy, Debug)]
pub struct Curve<'a> {
    /// The demand at which the thrust stands still.
    pub neutral: f64,
    /// Increasing demands from the neutral; a demand beyond them counts as the nearest.
    pub knots: &'a [f64],
    /// By piece: coefficients of the cubic in the distance from the lower knot, lowest power first.
    pub pieces: &'a [[f64; 4]],
}

/// A piecewise linear function, constant beyond its knots.
#[derive(Clone, Copy, Debug)]
pub struct Line<'a> {
    /// Increasing places.
    pub knots: &'a [f64],
    /// Its value at each.
    pub values: &'a [f64],
}

/// An error of a thrust, as a share of its bound: one function of the demand, and another that is added where the
/// demand has risen last and subtracted where it has fallen.
#[derive(Clone, Copy, Debug)]
pub struct Error<'a> {
    /// The bound in newtons where there is thrust.
    pub absolute: f64,
    /// The bound as a share of the thrust.
    pub relative: f64,
    /// The function of the demand.
    pub curve: Line<'a>,
    /// The hysteresis, if any.
    pub branch: Option<Line<'a>>,
}

/// Thrusts at demands from the neutral in the order of time.
///
/// The demands are shared between at most `threads` threads, and no result depends on their number.
///
/// # Panics
/// Lengths that do not fit each other.
pub fn thrust(demand: &[f64], curve: Curve, error: Option<Error>, threads: usize, out: &mut [f64]) {
    assert_eq!(demand.len(), out.len(), "a place for each thrust is needed");
    assert!(curve.knots.len() >= 2 && curve.pieces.len() + 1 == curve.knots.len(), "a piece between knots is needed");
    let error = error.map(|e| (e.absolute, e.relative, Sloped::of(e.curve), e.branch.map(Sloped::of)));
    let share = demand.len().div_ceil(threads.clamp(1, (demand.len() / WORTHWHILE).max(1))).max(1);
    let work = |first: usize, out: &mut [f64]| {
        let mut risen = rose(demand, first);
        let mut piece = 0;
        let mut at = (0, 0);
        for (t, place) in out.iter_mut().enumerate() {
            let d = demand[first + t];
            let push = pushed(d, curve, &mut piece);
            *place = push;
            let Some((absolute, relative, line, branch)) = &error else { continue };
            let mut size = line.value(d, &mut at.0);
            if let Some(branch) = branch {
                if let Some(before) = (first + t).checked_sub(1).map(|b| demand[b])
                    && before != d
                {
                    risen = d > before;
                }
                let side = if risen { 1.0 } else { -1.0 };
                size += side * branch.value(d, &mut at.1);
            }
            *place = push + (absolute + relative * push.abs()) * size;
        }
    };
    std::thread::scope(|scope| {
        let mut parts = out.chunks_mut(share).enumerate();
        let own = parts.next();
        for (k, part) in parts {
            let work = &work;
            scope.spawn(move || work(k * share, part));
        }
        if let Some((_, part)) = own {
            work(0, part);
        }
    });
}

/// Thrust at a demand from the neutral; `piece` is where the last one was found.
#[inline]
fn pushed(demand: f64, curve: Curve, piece: &mut usize) -> f64 {
    let (first, last) = (curve.knots[0] + curve.neutral, curve.knots[curve.knots.len() - 1] + curve.neutral);
    let d = demand + curve.neutral;
    // A demand that is no number stays none.
    let d = if d < first {
        first
    } else if d > last {
        last
    } else {
        d
    } - curve.neutral;
    let at = below(curve.knots, d, *piece).clamp(0, curve.pieces.len() - 1);
    *piece = at;
    let s = d - curve.knots[at];
    let c = &curve.pieces[at];
    c[0] + c[1] * s + c[2] * (s * s) + c[3] * (s * s * s)
}

/// The last knot that is not above a number, the first one if all are; the search starts at a guess.
#[inline]
fn below(knots: &[f64], x: f64, guess: usize) -> usize {
    let mut k = guess;
    while k > 0 && x < knots[k] {
        k -= 1;
    }
    while k + 1 < knots.len() && x >= knots[k + 1] {
        k += 1;
    }
    k
}

/// Whether the last change before a sample was a rise; a first stretch counts as risen.
fn rose(demand: &[f64], at: usize) -> bool {
    let last = demand[..at].windows(2).rev().find(|w| w[1] != w[0]);
    last.is_none_or(|w| w[1] > w[0])
}

/// A piecewise linear function with the slope of each piece.
struct Sloped<'a> {
    line: Line<'a>,
    slopes: Vec<f64>,
}

impl<'a> Sloped<'a> {
    fn of(line: Line<'a>) -> Self {
        assert!(!line.knots.is_empty() && line.knots.len() == line.values.len(), "a value for each knot is needed");
        let slopes = line.knots.windows(2).zip(line.values.windows(2)).map(|(x, y)| (y[1] - y[0]) / (x[1] - x[0]));
        Sloped { line, slopes: slopes.collect() }
    }

    #[inline]
    fn value(&self, x: f64, guess: &mut usize) -> f64 {
        let Line { knots, values } = self.line;
        let k = below(knots, x, *guess);
        *guess = k;
        if k + 1 == knots.len() || x <= knots[k] {
            return values[k];
        }
        self.slopes[k] * (x - knots[k]) + values[k]
    }
}
