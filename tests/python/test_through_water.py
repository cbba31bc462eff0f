"""Velocities and rates through the water, against a motion whose derivatives are taken in exact series."""

import gmpy2
import numpy as np
from gmpy2 import mpfr

from ivsid.intervals import IntervalArray
from ivsid.sensors.corrections import through_water


def test_velocities_and_rates_through_the_water_hold_the_truth():
    """The current turns in the axes of a vessel that turns: by the rotation of its components, to 200 bits."""
    rng = np.random.default_rng(6)
    n = 200
    columns = {c: rng.uniform(-1.5, 1.5, n) for c in ("u", "v", "udot", "vdot", "r")}
    columns["psi"] = rng.uniform(-3.0, 3.0, n)
    channels = {c: IntervalArray(x - 1e-6, x + 1e-6) for c, x in columns.items()}
    present = {c: np.ones(n, dtype=bool) for c in columns}
    speed = through_water(channels, present, ((0.2, 0.21), (-0.35, -0.34)))
    with gmpy2.context(precision=200):
        step = mpfr(2) ** -60
        for stated in (("0.2", "-0.35"), ("0.21", "-0.34"), ("0.205", "-0.345")):
            north, east = map(mpfr, stated)
            assert gmpy2.sqrt(north**2 + east**2) <= mpfr(speed)
            for k in range(n):
                psi, r = mpfr(columns["psi"][k]), mpfr(columns["r"][k])

                def ahead(angle, north=north, east=east):
                    return north * gmpy2.cos(angle) + east * gmpy2.sin(angle)

                def across(angle, north=north, east=east):
                    return east * gmpy2.cos(angle) - north * gmpy2.sin(angle)

                for name, of in (("u", ahead), ("v", across)):
                    low, high = (mpfr(getattr(channels[name], end)[k]) for end in ("lower", "upper"))
                    assert low <= mpfr(columns[name][k]) - of(psi) <= high
                    # The rate of the component while the heading turns at r, as a central difference whose error is 1e-36.
                    rate = (of(psi + r * step) - of(psi - r * step)) / (2 * step)
                    low, high = (mpfr(getattr(channels[f"{name}dot"], end)[k]) for end in ("lower", "upper"))
                    assert low <= mpfr(columns[f"{name}dot"][k]) - rate <= high
    assert channels["udot"].width.max() < 0.06 and channels["u"].width.max() < 0.03
