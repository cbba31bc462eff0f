//! Errors become generators, and the smallest generators a box, so that their number stays fixed.
//!
//! **Theorem (reduction).** A zonotope lies in the one whose chosen generators are replaced by the axis-parallel box of
//! their sums of moduli. (Source: Girard, HSCC 2005, section 3.1; Kühn, Computing 61 (1998), section 4.)

use super::form::Form;
use crate::rounding::add_up;

/// Generators that are kept, for each component.
const KEPT: usize = 24;

/// The same sets with all errors as generators, at most `KEPT` for each component and one box.
pub fn reduce(forms: &mut [Form]) {
    let dimension = forms.len();
    let present = forms.first().map_or(0, |form| form.generators.len());
    if present + dimension > KEPT * dimension {
        let size = |j: usize| forms.iter().map(|form| form.generators[j].abs()).fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..present).collect();
        order.sort_by(|&i, &j| size(j).total_cmp(&size(i)));
        // Half of them go at once: boxes are seldom made, and then of small ones.
        let (kept, gone) = order.split_at(KEPT * dimension / 2);
        for form in forms.iter_mut() {
            form.error = gone.iter().fold(form.error, |sum, &j| add_up(sum, form.generators[j].abs()));
            form.generators = kept.iter().map(|&j| form.generators[j]).collect();
        }
    }
    for (i, form) in forms.iter_mut().enumerate() {
        form.generators.extend((0..dimension).map(|j| if i == j { form.error } else { 0.0 }));
        form.error = 0.0;
    }
}
