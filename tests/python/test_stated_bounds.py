"""Bounds that a guarantee rests on, each against a number worked out by hand: in the rows, and in those of the checker.

Readings here are exact (an accuracy of a millionth), so a row shows the one bound that a test is about. Every bound is asked twice: a row holds the
worst case that the statement allows, and it is not wider than that by more than rounding and the millionths.
"""

from dataclasses import replace
from fractions import Fraction
from statistics import NormalDist

import numpy as np
import pytest

from ivsid import identify, validate
from ivsid.diagnosis.null import levels
from ivsid.diagnosis.null.levels import split
from ivsid.effects import terms_of
from ivsid.log import Log
from ivsid.propulsion.lag import lagged
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.rows import build_rows
from ivsid.rows.integral import Quadrature
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import Thruster, parse_vehicle
from ivsid.verification.curves import Curve
from ivsid.verification.errors import UnprovedError
from ivsid.verification.rational import Range
from ivsid.verification.readings import Readings
from ivsid.verification.rows import Rows

TINY = 1e-6
BARE = f"""
name = "bare"
[hull]
mass = 50
[sensors.velocity]
accuracy = {TINY}
[sensors.yaw_rate]
accuracy = {TINY}
[sensors.force]
accuracy = {TINY}
[sensors.moment]
accuracy = {TINY}
[sensors.limits]
acceleration = 0.8
yaw_acceleration = 0.5
[model]
terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear", "drag.sway.linear", "drag.yaw.linear"]
"""
AMBIENT = "[ambient]\nforce = 0.25\nmoment = 2.0\ntime = 2.0\n"
CHANNELS = ("surge", "sway", "yaw")


def bare(more=""):
    return parse_vehicle(BARE + more, "bare.toml")


def still(n=40, h=0.1, **columns):
    """A log at rest without forces, but for the columns that are given."""
    rest = {name: np.zeros(n) for name in ("u", "v", "r", "force_X", "force_Y", "moment_N")}
    return Log("still.csv", "0" * 64, np.arange(n) * h, {**rest, **columns})


def rows_of(vehicle, log, kind="integral", window=1.0, windows=1):
    return build_rows(bound_log(log, vehicle, windows), vehicle, terms_of(vehicle), kind=kind, window=window)


def inside(value, low, high, spare=1e-4):
    """Whether a bound is at least what it has to be, and hardly more."""
    return low <= value <= high + spare


@pytest.mark.parametrize("kind", ["pointwise", "integral"])
@pytest.mark.parametrize("stated", ["", "confidence = 0.9\n", "sigmas = 5.0\n"])
def test_the_ambient_force_and_the_moment_have_their_own_bounds(kind, stated):
    """k standard deviations of each: k by the normal distribution, and the union bound over all samples and window means."""
    rates = (
        "[sensors.acceleration]\naccuracy = 1e-6\n[sensors.yaw_acceleration]\naccuracy = 1e-6\n"
        if kind == "pointwise"
        else ""
    )
    columns = {n: np.zeros(40) for n in ("udot", "vdot", "rdot")} if kind == "pointwise" else {}
    # Keys of [sensors] stand before its sections.
    text = BARE.replace("[sensors.velocity]", f"[sensors]\n{stated}[sensors.velocity]", 1) + rates + AMBIENT
    vehicle, log = parse_vehicle(text, "bare.toml"), still(**columns)
    errors = 40 * 2 * 3
    confidence = 0.9 if "confidence" in stated else 0.999
    k = 5.0 if "sigmas" in stated else NormalDist().inv_cdf(1 - (1 - confidence) / (2 * errors))
    made = rows_of(vehicle, log, kind)
    own = Rows(log, vehicle, "total")
    for index, (channel, size) in enumerate(zip(CHANNELS, (0.25, 0.25, 2.0), strict=True)):
        here = made.channel == index
        assert here.any()
        reach = np.minimum(made.right.upper[here], -made.right.lower[here])
        assert inside(reach.min(), k * size * (1 - 1e-9), k * size) and inside(
            reach.max(), k * size * (1 - 1e-9), k * size
        )
        at = int(np.flatnonzero(here)[3])
        row = own.row(kind, channel, float(made.time[at]), float(made.duration[at]))
        assert inside(float(row.right.upper), k * size * (1 - 1e-9), k * size)
        assert inside(float(-row.right.lower), k * size * (1 - 1e-9), k * size)


def test_each_length_of_window_counts_in_the_bound_of_the_checker_as_well():
    vehicle, log = bare(AMBIENT), still()
    for windows in (1, 2, 5):
        k = NormalDist().inv_cdf(1 - 0.001 / (2 * 40 * (1 + windows) * 3))
        assert bound_log(log, vehicle, windows).ambient == pytest.approx((0.25 * k, 2.0 * k), rel=1e-8)
        force, moment = Readings(log, vehicle, windows=windows).ambient
        assert float(force.upper) == pytest.approx(0.25 * k, rel=1e-6) and float(moment.upper) == pytest.approx(
            2.0 * k, rel=1e-6
        )


def zigzag(a, h):
    """The mean over each step of a motion that is 0 at every row, rises by ``a`` to the middle of a step and falls again."""
    return a * h / 4


@pytest.mark.parametrize("window", [0.1, 1.0])
def test_a_mean_between_rows_holds_the_steepest_motion(window):
    """|udot| <= a allows a triangle on every step: its mean is a h / 4, where the readings say 0."""
    vehicle, log = bare(), still()
    made, own = rows_of(vehicle, log, window=window), Rows(log, vehicle, "total")
    for index, (channel, limit) in enumerate(zip(CHANNELS, (0.8, 0.8, 0.5), strict=True)):
        drag = [t.id for t in made.terms].index(f"drag.{channel}.linear")
        here = np.flatnonzero(made.channel == index)
        mean = zigzag(limit, 0.1)
        for end in (made.matrix.upper[here, drag], -made.matrix.lower[here, drag]):
            assert inside(end.min(), mean, mean) and inside(end.max(), mean, mean)
        row = own.row("integral", channel, float(made.time[here[2]]), float(made.duration[here[2]]))
        found = row.matrix[f"drag.{channel}.linear"]
        assert inside(float(found.upper), mean, mean) and inside(float(-found.lower), mean, mean)


def test_the_mean_of_a_square_holds_the_steepest_motion():
    """u is 1 at every row and swings by a h / 2 between them: the rate of u |u| is 2 |u| a, its largest at the peak."""
    text = BARE.replace('"drag.surge.linear"', '"drag.surge.quadratic"')
    vehicle, log = parse_vehicle(text, "square.toml"), still(u=np.ones(40))
    a, h = 0.8, 0.1
    peak = 1 + a * h / 2
    mean = (peak**3 - 1) / (3 * a * h / 2)
    made, own = rows_of(vehicle, log), Rows(log, vehicle, "total")
    drag = [t.id for t in made.terms].index("drag.surge.quadratic")
    here = np.flatnonzero(made.channel == 0)
    assert (made.matrix.upper[here, drag] >= mean).all() and (
        made.matrix.upper[here, drag] < 1 + 2 * peak * a * h / 4 + 1e-4
    ).all()
    found = own.row("integral", "surge", float(made.time[here[0]]), float(made.duration[here[0]])).matrix[
        "drag.surge.quadratic"
    ]
    assert found.upper >= Fraction(mean) and float(found.upper) < 1 + 2 * peak * a * h / 4 + 1e-4


def test_within_a_step_a_velocity_reaches_half_a_step_beyond_its_rows(monkeypatch):
    """0 at both rows and at most 0.8 m/s^2: 0.04 m/s in the middle of a tenth of a second, which the square's column shows."""
    vehicle, log = bare(), still()
    u, v, r = Rows(log, vehicle, "total").swept(3)()
    for found, reach in ((u, 0.04), (v, 0.04), (r, 0.025)):
        assert inside(float(found.upper), reach, reach) and inside(float(-found.lower), reach, reach)
    made = []
    plain = Quadrature.mean
    monkeypatch.setattr(Quadrature, "mean", lambda self, *words: (made.append(self), plain(self, *words))[1])
    rows_of(vehicle, log)
    for term, channel, reach in zip(terms_of(vehicle)[3:], CHANNELS, (0.04, 0.04, 0.025), strict=True):
        over = made[0].step_parts(term.columns, channel)[1]
        assert (
            term.id == f"drag.{channel}.linear"
            and inside(over.upper.min(), reach, reach)
            and inside(-over.lower.max(), reach, reach)
        )


def test_rows_of_more_lengths_than_were_bounded_are_refused():
    log = still()
    for windows in (1, 2):
        rows = Rows(log, bare(), "total", windows=windows)
        for last in range(10, 10 + windows):
            rows.row("integral", "surge", float(log.t[0]), float(log.t[last] - log.t[0]))
        with pytest.raises(UnprovedError, match=f"more than the {windows} lengths of window"):
            rows.row("integral", "surge", float(log.t[0]), float(log.t[20] - log.t[0]))


@pytest.mark.parametrize("missing", [1, 9])
def test_no_window_lies_over_missing_rows(missing):
    """One row that is lost, and nine: a step of two periods, and one of ten. The force in them may have been anything."""
    vehicle, whole = bare(), still(80)
    kept = np.r_[0:40, 40 + missing : 80]
    log = Log("lost.csv", "0" * 64, whole.t[kept], {n: x[kept] for n, x in whole.columns.items()})
    made = rows_of(vehicle, log)
    assert (
        made.time.size and not ((made.time < log.t[40] - 1e-9) & (made.time + made.duration > log.t[39] + 1e-9)).any()
    )
    for last in range(40, 46):
        with pytest.raises(UnprovedError, match="has a gap"):
            Rows(log, vehicle, "total").row("integral", "surge", float(log.t[35]), float(log.t[last] - log.t[35]))


def thruster(**changes):
    return Thruster.model_validate({"name": "p", **changes})


class Demands:
    """As much of the checker's readings as a curve asks for: decimals of the file."""

    @staticmethod
    def exact(number):
        return Range(Fraction(repr(float(number))))


def both_curves(given, low, high):
    """The thrusts over a range of demands: of the product, and of the checker."""
    made = ThrustCurve(given).interval(np.array([low]), np.array([high]))
    own = Curve(given, Demands()).thrust(Range(Fraction(repr(low)), Fraction(repr(high))))
    return (float(made.lower[0]), float(made.upper[0])), (float(own.lower), float(own.upper))


def test_the_relative_accuracy_is_of_the_largest_thrust_in_a_range():
    """From 0 N to 100 N at 10 %: 110 N is possible, and 105 N, of the middle, is too little."""
    given = thruster(gain=1.0, demand_range=(-200, 200), accuracy={"relative": 0.1, "absolute": 2.0})
    for low, high in both_curves(given, 0.0, 100.0):
        assert inside(high, 112.0 - 1e-9, 112.0) and inside(-low, 12.0 - 1e-9, 12.0)
    for low, high in both_curves(given, -100.0, 20.0):
        assert inside(-low, 112.0 - 1e-9, 112.0) and inside(high, 32.0 - 1e-9, 32.0)


def test_a_range_that_reaches_into_the_dead_band_holds_zero():
    """Demands from 10 to 30 with a dead band of 20: no thrust at all, or up to 30 N."""
    given = thruster(gain=1.0, demand_range=(-100, 100), dead_band=20.0, accuracy={"absolute": 0.001})
    for (low, high), least, most in (
        ((10.0, 30.0), 0, 30),
        ((-30.0, -10.0), -30, 0),
        ((-5.0, 5.0), 0, 0),
        ((25.0, 30.0), 25, 30),
    ):
        for lower, upper in both_curves(given, low, high):
            assert least - 0.002 <= lower <= least and most <= upper <= most + 0.002


def test_the_reverse_factor_is_of_thrust_astern_alone():
    given = thruster(gain=1.0, demand_range=(-100, 100), reverse_factor=0.5, accuracy={"absolute": 0.001})
    for lower, upper in both_curves(given, -40.0, 60.0):
        assert -20.002 <= lower <= -20 and 60 <= upper <= 60.002


@pytest.mark.parametrize("span", [(-2.0, 3.0), (-4.0, 4.0), (0.5, 1.5)])
def test_knots_inside_a_range_of_demands_count(span):
    """A table that rises to 50 N at demand 1, and falls: the extremes of a range stand at knots inside it."""
    table = {"demand": [-5, -3, -1, 0, 1, 2, 5], "thrust": [0, -30, -10, 0, 50, 5, 20]}
    given = thruster(table=table, accuracy={"absolute": 0.001})
    knots = [f for d, f in zip(table["demand"], table["thrust"], strict=True) if span[0] <= d <= span[1]]
    for low, high in both_curves(given, *span):
        assert low <= min(knots) and high >= max(knots) and high <= 50.1


def test_a_row_sees_the_largest_error_of_its_thruster():
    """Demands that go from 0 to 100 between two rows: the mean of the step is anything up to 110 N."""
    text = BARE.replace(f"[sensors.force]\naccuracy = {TINY}\n[sensors.moment]\naccuracy = {TINY}\n", "")
    pusher = '[[thrusters]]\nname = "stern"\nposition = [-0.5, 0.0]\ngain = 1.0\ndemand_range = [-200, 200]\naccuracy = { relative = 0.1 }\n'
    vehicle = parse_vehicle(text + pusher + '[log]\ndemand = "linear"\n', "pushed.toml")
    columns = {n: np.zeros(40) for n in ("u", "v", "r")}
    log = Log(
        "p.csv", "0" * 64, np.arange(40) * 0.1, {**columns, "demand_stern": np.where(np.arange(40) % 2, 100.0, 0.0)}
    )
    made, own = rows_of(vehicle, log, window=0.1), Rows(log, vehicle, "total")
    here = np.flatnonzero(made.channel == 0)
    # The mean of a straight line from 0 to 100 N, each point of it with an error of a tenth: up to 55 N.
    assert (made.right.upper[here] >= 55.0).all() and (made.right.upper[here] <= 110.01).all()
    row = own.row("integral", "surge", float(made.time[here[0]]), float(made.duration[here[0]]))
    assert row.right.upper >= 55 and row.right.upper <= 111


def test_the_levels_of_a_diagnosis_are_those_of_the_documentation():
    """One log in a hundred may get a wrong verdict, all statements together; the names take half of that."""
    parts = split()
    assert parts["whole"] == levels.VERDICT <= 0.01
    assert parts["names"] + parts["structure"] + parts["shallow_water"] == pytest.approx(parts["whole"], abs=1e-12)
    assert parts["names"] == levels.NAMES == 0.005 and parts["structure"] == levels.STRUCTURE == 0.0025


@pytest.mark.parametrize("windows", [[1.0], [0.5, 1.0, 2.0]])
def test_a_validation_counts_the_errors_that_the_identification_counts(windows, monkeypatch):
    """Rows over three lengths of window are three means of the ambient force: the same bound holds in both commands."""
    vehicle = bare(AMBIENT)
    t = np.arange(60) * 0.1
    u = 0.5 * np.sin(2 * t)
    log = Log("moved.csv", "0" * 64, t, {**still(60).columns, "u": u, "force_X": 50 * np.cos(2 * t)})
    fit = identify(vehicle, log, rows="integral", window=windows, examine=False)
    k = NormalDist().inv_cdf(1 - 0.001 / (2 * 60 * (1 + len(windows)) * 3))
    said = next(s for s in fit.assumes if s.startswith("ambient force"))
    assert f"{0.25 * k:.3g} N" in said
    check = validate(replace(fit, estimate=dict.fromkeys(fit.parameters, 1.0) or {"mass.surge": 50.0}), log)
    yaw = next(f for f in check.forces if f.channel == "yaw")
    assert inside(yaw.measured.upper.max(), 2.0 * k * (1 - 1e-9), 2.0 * k)


def test_a_gyro_that_averages_may_be_half_a_step_behind():
    """|rdot| <= 0.5 rad/s^2 over a tenth of a second: the rate lies within 0.025 rad/s of the mean that was read."""
    vehicle = bare().text.replace("[sensors.yaw_rate]", '[sensors.yaw_rate]\nsampling = "averaged"')
    vehicle = parse_vehicle(vehicle, "averaging.toml")
    log = still()
    r = bound_log(log, vehicle).channels["r"]
    assert inside(r.upper.min(), 0.025, 0.025) and inside(-r.lower.max(), 0.025, 0.025)
    own = Readings(log, vehicle).channel("r", 5)
    assert inside(float(own.upper), 0.025, 0.025) and inside(float(-own.lower), 0.025, 0.025)


def test_a_heading_has_its_whole_accuracy():
    vehicle = bare("[sensors.heading]\naccuracy = 0.02\n")
    log = still(psi=np.zeros(40))
    psi = bound_log(log, vehicle).channels["psi"]
    assert (psi.upper >= 0.02).all() and (psi.lower <= -0.02).all() and (psi.upper < 0.020001).all()
    own = Readings(log, vehicle).heading(5)
    assert float(own.upper) >= 0.02 and float(own.upper) < 0.020001 and float(own.lower) <= -0.02


def test_what_a_thruster_did_before_the_log_is_anything():
    """Behind a lag of ten seconds the first force is any force of the curve, from -20 N to 30 N, whatever is demanded."""
    given = thruster(gain=1.0, demand_range=(-20, 30), time_constant=10.0, accuracy={"absolute": 0.001})
    log = still(demand_p=np.full(40, 10.0))
    for lag in ("thrust", "demand"):
        curve = ThrustCurve(given.model_copy(update={"lag": lag}))
        at, over = lagged(curve, np.full(40, 10.0), np.zeros(40), log, np.ones(40, dtype=bool), 10.0)
        assert at.lower[0] <= -20 and at.upper[0] >= 30 and at.upper[0] < 30.1
        # A step later an hundredth of the difference to 10 N has gone.
        later = 10 + 20 * np.exp(-0.01)
        assert at.upper[1] >= later and at.upper[1] < later + 0.01
        assert over.upper[0] >= (30 + later) / 2 - 0.01
