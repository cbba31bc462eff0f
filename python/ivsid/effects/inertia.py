"""Masses, inertia, and the coupling between channels (EFFECTS.md 2.0, 2.2)."""

from typing import Final

from ivsid.effects.terms import Term, square

MASS_SURGE: Final = Term("mass.surge", "m - X_udot", "kg", lambda s: {"surge": s.udot, "sway": s.u * s.r})
MASS_SWAY: Final = Term("mass.sway", "m - Y_vdot", "kg", lambda s: {"surge": -(s.v * s.r), "sway": s.vdot})
INERTIA_YAW: Final = Term("inertia.yaw", "I_z - N_rdot", "kg m^2", lambda s: {"yaw": s.rdot})

# Paper eq. 3-6: one mass for surge and sway. With the rigid-body mass known, the same columns belong to the added mass.
SHARED_MASS: Final = Term("mass.surge", "m - X_udot", "kg", lambda s: {"surge": s.ax, "sway": s.ay})
ADDED_MASS: Final = Term("added_mass.surge", "-X_udot", "kg", lambda s: {"surge": s.ax, "sway": s.ay})
ADDED_MASS_SURGE: Final = Term("added_mass.surge", "-X_udot", "kg", MASS_SURGE.columns)
ADDED_MASS_SWAY: Final = Term("added_mass.sway", "-Y_vdot", "kg", MASS_SWAY.columns)

COUPLING_CG_X: Final = Term(
    "coupling.cg_x", "m x_G - Y_rdot", "kg m", lambda s: {"surge": -square(s.r), "sway": s.rdot, "yaw": s.ay}
)
COUPLING_CG_Y: Final = Term(
    "coupling.cg_y", "m y_G", "kg m", lambda s: {"surge": -s.rdot, "sway": -square(s.r), "yaw": -s.ax}
)
MUNK: Final = Term("added_mass.munk", "X_udot - Y_vdot", "kg", lambda s: {"yaw": s.u * s.v})

FAMILY: Final = (MASS_SURGE, MASS_SWAY, INERTIA_YAW, COUPLING_CG_X, COUPLING_CG_Y, MUNK)
