//! Outcomes as values: each kind of answer has its own statuses, and no others.

use crate::names::named;

named! {
    /// The status of an inverse or of the solution of a square system.
    Status, "status" {
        /// The value encloses every result; proved.
        Enclosed => "enclosed",
        /// The matrix contains a singular member; proved.
        Singular => "singular",
        /// Neither an enclosure nor its impossibility was proved. A value that stands beside it claims nothing.
        NotProved => "not_proved",
        /// The method's own conditions of use do not hold.
        NotApplicable => "not_applicable",
    }
}

named! {
    /// The verdict on the regularity of an interval matrix.
    Verdict, "verdict" {
        /// Every member is nonsingular; proved.
        Regular => "regular",
        /// Some member is singular; proved.
        Singular => "singular",
        /// Neither was proved.
        NotProved => "not_proved",
    }
}

named! {
    /// The status of a feasible set.
    FeasibleStatus, "status" {
        /// Every parameter has two finite bounds; proved.
        Enclosed => "enclosed",
        /// No parameter is consistent with the rows; proved.
        Empty => "empty",
        /// At least one end has no finite bound. The finite ends that are given are proved.
        Unbounded => "unbounded",
        /// The method's own conditions of use do not hold.
        NotApplicable => "not_applicable",
    }
}

named! {
    /// The status of an enclosure of all least-squares solutions.
    LeastSquaresStatus, "status" {
        /// The value encloses every solution; proved.
        Enclosed => "enclosed",
        /// No enclosure was proved.
        NotProved => "not_proved",
        /// The method's own conditions of use do not hold.
        NotApplicable => "not_applicable",
    }
}
