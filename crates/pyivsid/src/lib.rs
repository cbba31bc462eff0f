//! The functions of `interval-core` and `onboard` for Python: borrow, detach from the interpreter, call, convert. No arithmetic and
//! no decisions.

#![expect(clippy::needless_pass_by_value, reason = "pyfunction arguments are extracted by value")]

mod arrays;
mod convert;
mod elementwise;
mod filters;
mod found;
mod linalg;
mod names;
mod onboard;
mod regression;
mod reverses;
mod scalar;
mod tube;

use pyo3::prelude::*;

/// The compiled core of ivsid.
#[pymodule(name = "_core")]
mod core_module {
    #[pymodule_export]
    use super::elementwise::{
        backend, binary, check_bounds, environment_is_default, exact_sum, follow, format_interval, measure,
        outward_decimal, power, root, unary,
    };
    #[pymodule_export]
    use super::filters::{respond, thrust, whiten};
    #[pymodule_export]
    use super::found::Found;
    #[pymodule_export]
    use super::linalg::{
        cell_answers, default_count, gram, inverse, inverse_batch, inverse_of_parts, inverse_part, matmul, norm,
        partitioned_shared, regularity, regularity_batch, solve, solve_batch,
    };
    #[pymodule_export]
    use super::onboard::Follower;
    #[pymodule_export]
    use super::regression::{feasible_set, least_squares, normal_equations};
    #[pymodule_export]
    use super::reverses::{power_reverse, reverse};
    #[pymodule_export]
    use super::scalar::Interval;
    #[pymodule_export]
    use super::tube::TubeModel;

    use pyo3::prelude::*;

    /// Adds the names and numbers that the core decides.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::names::add(module)
    }
}
