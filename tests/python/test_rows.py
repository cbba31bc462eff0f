"""Rows hold at the truth: the one property that everything after them rests on."""

from dataclasses import replace

import numpy as np
import polars as pl
import pytest

from conftest import as_log
from ivsid import IntervalArray, IvsidError, identify, read_log
from ivsid.effects import CATALOGUE, terms_of
from ivsid.log import Log
from ivsid.programme.scenario import Start
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.rows import build_rows
from ivsid.rows.motion import Motion
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

FULL = [
    "mass.surge",
    "mass.sway",
    "inertia.yaw",
    "drag.surge.quadratic",
    "drag.sway.quadratic",
    "drag.surge.linear",
    "drag.surge.cubic",
    "drag.surge.sideslip",
    "drag.sway.linear",
    "drag.sway.cubic",
    "drag.sway.yaw_rate",
    "drag.yaw.linear",
    "drag.yaw.quadratic",
    "drag.yaw.cubic",
    "drag.lift.sway",
    "drag.lift.yaw",
    "coupling.cg_x",
    "coupling.cg_y",
    "added_mass.munk",
    "drag.surge.astern",
    "friction.coulomb",
    "drag.cross_flow",
]
VALUES = dict(
    zip(FULL, [60, 75, 8, 200, 300, 20, 12, 30, 15, 200, 4, 1.5, 2, 3, 10, -3, 1.0, 0.4, 6, 20, 1.5, 25], strict=True)
)


def violated(rows, values) -> int:
    """Rows whose interval equation misses the true parameter."""
    theta = IntervalArray(np.array([values[t.id] for t in rows.terms], dtype=float))
    residual = rows.matrix @ theta - rows.right
    return int((~residual.contains(np.zeros(residual.shape))).sum())


@pytest.mark.parametrize("kind", ["auto", "pointwise", "integral", "both"])
def test_rows_hold_at_the_truth(swan, twin, kind):
    rows = build_rows(bound_log(as_log(twin), swan), swan, terms_of(swan), kind=kind)
    assert rows.time.size > 3000
    assert violated(rows, twin.truth["parameters"]) == 0


@pytest.mark.parametrize("window", [0.05, 0.5, 2.0])
def test_every_catalogue_term_in_rows_and_in_motion(swan, programme, window):
    terms = ", ".join(f'"{i}"' for i in FULL)
    text = swan.text.replace('terms = "paper"', f"terms = [{terms}]")
    vehicle = parse_vehicle(text, "full.toml")
    assert {t.id for t in terms_of(vehicle)} == set(CATALOGUE)
    made = simulate(vehicle, programme.model_copy(update={"noise": "uniform", "truth": VALUES}), 3)
    assert np.abs(made.exact["udot"]).max() < 2.5 and np.abs(made.exact["rdot"]).max() < 1.5, "the stated limits hold"
    rows = build_rows(bound_log(as_log(made), vehicle), vehicle, terms_of(vehicle), kind="both", window=window)
    assert set(rows.channel) == {0, 1, 2}
    assert violated(rows, VALUES) == 0


def test_added_mass_form_holds_at_the_truth(swan, twin):
    rows = build_rows(bound_log(as_log(twin), swan), swan, terms_of(swan, "added"), added_mass=True)
    values = twin.truth["parameters"]
    values = {**values, "added_mass.surge": values["mass.surge"] - swan.hull.mass}
    assert violated(rows, values) == 0


def test_missing_samples_and_gaps_leave_rows_out(swan, twin):
    columns = {k: v.copy() for k, v in twin.columns.items()}
    columns["u"][100:200] = np.nan
    columns["demand_port"][300] = np.nan
    t = twin.t.copy()
    t[500:] += 3.0
    log = Log("gaps.csv", "", t, columns)
    rows = build_rows(bound_log(log, swan), swan, terms_of(swan))
    assert violated(rows, twin.truth["parameters"]) == 0
    surge = rows.time[rows.channel == 0]
    assert not np.isin(t[100:200], surge).any() and t[300] not in surge
    yaw = rows.channel == 2
    across = (rows.time[yaw] < t[500]) & (rows.time[yaw] + rows.duration[yaw] > t[499] + 1e-9)
    assert not across.any()


def test_measured_derivatives_are_preferred(swan, twin):
    text = swan.text + "\n[sensors.yaw_acceleration]\naccuracy = 0.001\n"
    vehicle = parse_vehicle(text, "rdot.toml")
    columns = {**twin.columns, "rdot": twin.exact["rdot"], "udot": twin.exact["udot"], "vdot": twin.exact["vdot"]}
    rows = build_rows(bound_log(Log("r.csv", "", twin.t, columns), vehicle), vehicle, terms_of(vehicle))
    assert (rows.duration == 0).all() and violated(rows, twin.truth["parameters"]) == 0


@pytest.mark.parametrize(
    ("drop", "edit", "sentence"),
    [
        (["u"], ("", ""), "no column u"),
        (["demand_port"], ("", ""), "no column demand_port.*thruster port"),
        (
            ["ax", "ay"],
            ("[sensors.limits]\nacceleration = 2.5\nyaw_acceleration = 1.5\n", ""),
            "needs \\[sensors.limits\\]",
        ),
        (
            [],
            ("[sensors.limits]\nacceleration = 2.5\nyaw_acceleration = 1.5\n", ""),
            "yaw acceleration|needs \\[sensors.limits\\]",
        ),
    ],
)
def test_what_is_missing_is_said(swan, twin, drop, edit, sentence):
    vehicle = parse_vehicle(swan.text.replace(*edit) if edit[0] else swan.text, "swan.toml")
    columns = {k: v for k, v in twin.columns.items() if k not in drop}
    with pytest.raises(IvsidError, match=sentence):
        build_rows(bound_log(Log("x.csv", "", twin.t, columns), vehicle), vehicle, terms_of(vehicle))


def test_rates_of_change_bound_the_difference():
    rng = np.random.default_rng(1)
    for name, function in {
        "product": lambda a, b: a * b,
        "square": lambda a, b: a.square() + b if hasattr(a, "square") else a * a + b,
        "drag": lambda a, b: (a.signed_square() if hasattr(a, "signed_square") else a * abs(a)) - 2.0 * b,
        "modulus": lambda a, b: abs(a) * b,
        "reversed": lambda a, b: 1.0 - a,
    }.items():
        a0, b0, da, db = rng.uniform(-1, 1, 4)
        s = np.linspace(0, 1, 101)
        a, b = a0 + da * s, b0 + db * s
        ranges = [Motion(IntervalArray(x.min(), x.max()), IntervalArray(d)) for x, d in ((a, da), (b, db))]
        found = function(*ranges)
        exact = function(a, b)
        assert found.value.lower - 1e-12 <= exact.min() and exact.max() <= found.value.upper + 1e-12, name
        slope = np.abs(np.diff(exact)).max() * 100
        assert slope <= found.rate.magnitude + 1e-9, name


def test_linear_demands_sweep_each_curve_on_its_own(swan):
    """Two thrusters that ramp against each other: the sum of the ends is no bound for what lies between."""
    text = swan.text.replace("centre_of_gravity = [-0.00106, -0.00295]", "").replace(
        'terms = "paper"', 'terms = ["mass.surge"]'
    )
    vehicle = parse_vehicle(text + '\n[log]\ndemand = "linear"\n', "ramp.toml")
    t = np.arange(200) * 1.0
    up = np.where(np.arange(200) % 2 == 0, 15.0, 85.0)
    demands = {"port": up, "starboard": 100.0 - up}
    fine = np.linspace(0, 1, 2001)
    curve = ThrustCurve(vehicle.thrusters[0])
    inside = [
        sum(curve.value(a + (b - a) * fine) for a, b in ((d[k], d[k + 1]) for d in demands.values())).mean()
        for k in (0, 1)
    ]
    mass = 60.0
    mean = np.array([inside[k % 2] for k in range(199)])
    u = np.r_[0.0, np.cumsum(mean / mass)]
    columns = {"u": u, "v": np.zeros(200), "r": np.zeros(200), **{f"demand_{n}": d for n, d in demands.items()}}
    rows = build_rows(bound_log(Log("ramp.csv", "", t, columns), vehicle), vehicle, terms_of(vehicle), window=1.0)
    surge = rows.take(rows.channel == 0, [0])
    residual = surge.matrix @ IntervalArray(np.array([mass])) - surge.right
    assert residual.contains(np.zeros(residual.shape)).all() and residual.size > 150


def test_decimal_times_and_readings_are_enclosed(swan):
    """t = k/10 and u = 3 t are no doubles; the exact equation m udot = X must still lie in every row."""
    text = (
        'name = "exact"\n[hull]\nmass = 10\n[sensors.velocity]\naccuracy = 0\n[sensors.yaw_rate]\naccuracy = 0\n'
        "[sensors.force]\naccuracy = 0\n[sensors.moment]\naccuracy = 0\n[sensors.limits]\nacceleration = 3\nyaw_acceleration = 1\n"
        '[model]\nterms = ["mass.surge"]\n'
    )
    vehicle = parse_vehicle(text, "exact.toml")
    k = np.arange(400)
    columns = {n: np.zeros(400) for n in ("v", "r", "force_Y", "moment_N")} | {
        "u": k * 3 / 10,
        "force_X": np.full(400, 21.0),
    }
    log = Log("exact.csv", "", np.array([float(f"{i / 10:.1f}") for i in k]), columns)
    rows = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), window=0.5)
    surge = rows.take(rows.channel == 0, [0])
    residual = surge.matrix @ IntervalArray(np.array([7.0])) - surge.right
    assert residual.contains(np.zeros(residual.shape)).all()
    assert residual.width.max() < 1e-9


def test_a_logged_force_may_move_between_its_rows():
    """X = 20 + 10 sin t drives a mass of 7 kg; the force is sampled, not held."""
    text = (
        'name = "force"\n[hull]\nmass = 10\n[sensors.velocity]\naccuracy = 0.0001\n[sensors.yaw_rate]\naccuracy = 0.0001\n'
        "[sensors.force]\naccuracy = 0.05\n[sensors.moment]\naccuracy = 0.05\n"
        '[sensors.limits]\nacceleration = 5\nyaw_acceleration = 1\n[model]\nterms = ["mass.surge"]\n'
    )
    vehicle = parse_vehicle(text, "force.toml")
    t = np.arange(600) * 0.1
    u = (20 * t + 10 * (1 - np.cos(t))) / 7.0
    zero = np.zeros(600)
    columns = {"u": u, "v": zero, "r": zero, "force_X": 20 + 10 * np.sin(t), "force_Y": zero, "moment_N": zero}
    rows = build_rows(bound_log(Log("force.csv", "", t, columns), vehicle), vehicle, terms_of(vehicle), window=0.3)
    surge = rows.take(rows.channel == 0, [0])
    residual = surge.matrix @ IntervalArray(np.array([7.0])) - surge.right
    assert residual.contains(np.zeros(residual.shape)).all() and residual.size > 500


HEADING = "\n[sensors.heading]\naccuracy = 0.004\n"


@pytest.mark.parametrize("window", [0.05, 0.5, 2.0])
def test_rows_hold_with_a_wind_that_keeps_its_direction(swan, programme, window):
    """The heading turns the columns: pointwise and over windows, through the jump of the logged angle, with missing headings."""
    text = swan.text.replace(
        'terms = "paper"', 'terms = ["mass.surge", "inertia.yaw", "drag.surge.quadratic", "mass.sway", "wind.steady"]'
    )
    vehicle = parse_vehicle(text + HEADING, "wind.toml")
    truth = {"mass.surge": 60.0, "mass.sway": 75.0, "inertia.yaw": 8.0, "drag.surge.quadratic": 250.0}
    truth |= {"wind.steady.north": 3.0, "wind.steady.east": -2.0}
    start = Start(psi=-2.5)
    made = simulate(vehicle, programme.model_copy(update={"noise": "uniform", "truth": truth, "start": start}), 5)
    assert np.abs(made.exact["udot"]).max() < 2.5 and np.abs(made.exact["rdot"]).max() < 1.5, "the stated limits hold"
    psi = np.angle(np.exp(1j * made.columns["psi"]))
    assert np.abs(np.diff(psi)).max() > 6
    psi[700:720] = np.nan
    log = Log("wind.csv", "0" * 64, made.t, {**made.columns, "psi": psi})
    rows = build_rows(bound_log(log, vehicle), vehicle, terms_of(vehicle), kind="both", window=window)
    assert violated(rows, truth) == 0
    over = (rows.duration > 0) & (rows.channel < 2)
    assert over.sum() > 2000
    across = over & (rows.time <= made.t[719]) & (rows.time + rows.duration >= made.t[700])
    assert not across.any()
    calm = build_rows(bound_log(log, swan), swan, terms_of(swan), kind="both", window=window)
    assert violated(calm, {**truth}) > 0


def test_a_wind_is_identified_from_two_headings(swan, programme):
    text = swan.text.replace(
        'terms = "paper"',
        'terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic", "wind.steady"]',
    )
    vehicle = parse_vehicle(text + HEADING, "wind.toml")
    truth = {"mass.surge": 60.0, "mass.sway": 75.0, "inertia.yaw": 8.0, "drag.surge.quadratic": 250.0}
    truth |= {"drag.sway.quadratic": 300.0, "wind.steady.north": 3.0, "wind.steady.east": -2.0}
    made = simulate(vehicle, programme.model_copy(update={"noise": "uniform", "truth": truth}), 5)
    fit = identify(vehicle, as_log(made))
    assert fit.status == "enclosed" and fit.guaranteed
    for id_, value in truth.items():
        assert fit.parameters[id_].lower <= value <= fit.parameters[id_].upper, id_
    assert fit.parameters["wind.steady.north"].lower > 0 > fit.parameters["wind.steady.east"].upper
    unbounded = parse_vehicle(text, "x.toml")
    with pytest.raises(IvsidError, match=r"no \[sensors.heading\]; it is needed to bound column psi"):
        identify(unbounded, Log("x.csv", "", made.t, {**made.columns, "psi": made.exact["psi"]}))
    with pytest.raises(IvsidError, match="no column psi .needed for wind.steady.north, wind.steady.east"):
        identify(vehicle, Log("x.csv", "", made.t, {k: v for k, v in made.columns.items() if k != "psi"}))


def test_a_force_that_pulses_between_the_rows_does_not_prove_a_wrong_mass(tmp_path):
    """The force stands at 100 Hz in the log, the rows at 10 Hz; motion in closed form, no noise."""
    mass, drag, h, rng = 50.0, 20.0, 0.01, np.random.default_rng(0)
    force = np.repeat(rng.uniform(-40, 40, 10), 400) * ((np.arange(4000) % 10 > 2) & (np.arange(4000) % 10 < 8))
    u = [0.0]
    for f in force:
        u.append(f / drag + (u[-1] - f / drag) * np.exp(-drag * h / mass))
    k = np.arange(4000)
    run = tmp_path / "run"
    run.mkdir()
    fine = {"t": k * h, "force_X": force, "force_Y": 0.0 * k, "moment_N": 0.0 * k}
    pl.DataFrame(fine).write_csv(run / "force.csv")
    rows = {"t": k * h, "u": np.array(u)[:-1], "v": 0.0 * k, "r": 1e-9 * (k // 10 % 3)}
    pl.DataFrame({n: x[::10] for n, x in rows.items()}).write_csv(run / "rows.csv")
    vehicle = parse_vehicle(
        'name = "a"\n[hull]\nmass = 50\n[sensors.velocity]\naccuracy = 1e-4\n[sensors.yaw_rate]\naccuracy = 1e-6\n[sensors.force]\n'
        "accuracy = 0.01\n[sensors.moment]\naccuracy = 0.01\n[sensors.limits]\nacceleration = 1.0\nyaw_acceleration = 0.1\n[log]\n"
        'base = "rows"\n[model]\nterms = ["mass.surge", "drag.surge.linear"]\n',
        "a.toml",
    )
    fit = identify(vehicle, read_log(run, vehicle.log))
    assert (
        fit.status in ("enclosed", "unbounded")
        and fit.parameters["mass.surge"].lower <= mass <= fit.parameters["mass.surge"].upper
    )
    assert fit.parameters["drag.surge.linear"].lower <= drag <= fit.parameters["drag.surge.linear"].upper
    assert "force_X lies between the values of neighbouring samples" in fit.assumes


def test_a_known_coupling_that_cancels_keeps_the_rounding_of_its_parts():
    """In decimals m x_G r^2 = -m y_G rdot exactly; the doubles of both parts are not each other's negative."""
    vehicle = parse_vehicle(
        'name = "a"\n[hull]\nmass = 3.3\ncentre_of_gravity = [0.1, -0.3]\n[sensors.velocity]\naccuracy = 1\n[sensors.yaw_rate]\n'
        "accuracy = 1\n[sensors.yaw_acceleration]\naccuracy = 1\n[sensors.acceleration]\naccuracy = 1\n[sensors.force]\naccuracy = 1\n"
        '[sensors.moment]\naccuracy = 1\n[model]\nterms = ["mass.surge"]\n',
        "a.toml",
    )
    names = ("u", "v", "r", "udot", "vdot", "rdot", "force_X", "force_Y", "moment_N")
    values = dict.fromkeys(names, 0.0) | {"r": 3.0, "rdot": 3.0}
    columns = {n: np.full(4, x) for n, x in values.items()}
    bounded = bound_log(Log("a.csv", "", np.arange(4.0), columns), vehicle)
    exact = {n: IntervalArray(np.full(4, x)) for n, x in values.items()}
    rows = build_rows(replace(bounded, channels=exact), vehicle, terms_of(vehicle), kind="pointwise")
    surge = rows.right[rows.channel == 0]
    assert surge.contains(np.zeros(4)).all() and surge.width.max() < 1e-12
