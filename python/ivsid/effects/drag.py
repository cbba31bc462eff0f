"""Drag, lift and damping (EFFECTS.md 2.0, 2.1). Positive parameters oppose the motion."""

from typing import Final

from ivsid.effects.terms import Term, signed_square, square

SURGE_QUADRATIC: Final = Term("drag.surge.quadratic", "-X_|u|u", "kg/m", lambda s: {"surge": signed_square(s.u)})
SWAY_QUADRATIC: Final = Term("drag.sway.quadratic", "-Y_|v|v", "kg/m", lambda s: {"sway": signed_square(s.v)})

# Paper eq. 6: one drag column for surge and sway (READING_NOTES: they are different coefficients).
SHARED_QUADRATIC: Final = Term(
    "drag.surge.quadratic", "-X_|u|u", "kg/m", lambda s: {"surge": signed_square(s.u), "sway": signed_square(s.v)}
)

FAMILY: Final = (
    SURGE_QUADRATIC,
    SWAY_QUADRATIC,
    Term("drag.surge.linear", "-X_u", "kg/s", lambda s: {"surge": s.u}),
    Term("drag.surge.sideslip", "-X_vv", "kg/m", lambda s: {"surge": square(s.v)}),
    Term("drag.sway.linear", "-Y_v", "kg/s", lambda s: {"sway": s.v}),
    Term("drag.sway.yaw_rate", "-Y_r", "kg m/s", lambda s: {"sway": s.r}),
    Term("drag.yaw.linear", "-N_r", "N m s", lambda s: {"yaw": s.r}),
    Term("drag.yaw.quadratic", "-N_|r|r", "N m s^2", lambda s: {"yaw": signed_square(s.r)}),
    Term("drag.lift.sway", "-Y_|u|v", "kg/m", lambda s: {"sway": abs(s.u) * s.v}),
    Term("drag.lift.yaw", "-N_uv", "kg", lambda s: {"yaw": s.u * s.v}),
)
