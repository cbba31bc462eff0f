//! A box that holds every solution over a whole step, and the proof that all exist that long.
//!
//! **Theorem (Picard and Lindelöf, with Carathéodory's measurable inputs).** Let `B` contain `X + [0, H] P` with `P` all
//! accelerations over `B` under all inputs. Then every solution that starts in `X` exists over the step, is unique for
//! its input, and stays in `X + [0, t] P` at time `t`. (The Picard operator maps the continuous functions into `B` with
//! start in `X` into themselves, and the right-hand side is Lipschitz in the velocities and measurable in time.
//! Source: Moore 1979, section 8.1; Nedialkov, Jackson and Corliss, Appl. Math. Comput. 105 (1999), section 4; Coddington
//! and Levinson 1955, chapter 2, for the inputs.)

use super::model::{Model, Three, Work};
use crate::interval::Interval;

/// Attempts to inflate a box that does not yet contain its own image.
const ATTEMPTS: usize = 12;

/// What is known of one step.
#[derive(Debug, Clone, Copy)]
pub struct Enclosure {
    /// Velocities over the whole step.
    pub nu: Three,
    /// Accelerations over the whole step.
    pub rates: Three,
}

/// Components that are given: their velocities and accelerations over the step.
#[derive(Debug, Clone, Copy)]
pub struct Given {
    /// Velocities; only those of components that are not free count.
    pub nu: Three,
    /// Accelerations likewise.
    pub rates: Three,
}

/// The box over a step of length within `[0, h.hi()]`; None where none is proved.
pub fn enclose(
    model: &Model,
    start: &Three,
    h: Interval,
    force: &Three,
    given: &Given,
    work: &mut Work,
) -> Option<Enclosure> {
    let span = Interval::raw(0.0, h.hi());
    let moved = |rates: &Three| -> Three {
        std::array::from_fn(|i| if model.free[i] { start[i] + span * rates[i] } else { given.nu[i] })
    };
    let mut nu: Three = std::array::from_fn(|i| if model.free[i] { start[i] } else { given.nu[i] });
    let mut inflation = 0.125;
    for _ in 0..ATTEMPTS {
        let rates = model.accelerations(&nu, force, &given.rates, work)?;
        let image = moved(&rates);
        if (0..3).all(|i| image[i].subset(nu[i])) {
            // Every solution stays in the image, so that its accelerations are those over the image.
            let rates = model.accelerations(&image, force, &given.rates, work)?;
            return Some(Enclosure { nu: image, rates });
        }
        for i in 0..3 {
            if model.free[i] {
                let reach = image[i].width() * inflation + f64::MIN_POSITIVE;
                nu[i] = nu[i].hull(image[i]) + Interval::raw(-reach, reach);
            }
        }
        inflation *= 2.0;
    }
    None
}
