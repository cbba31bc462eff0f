"""The accelerometer's bias as one unknown a log: holds the truth, and is narrower where the bias is slow and large."""

import numpy as np
import pytest

from conftest import as_log
from ivsid import IntervalArray, IvsidError, identify
from ivsid.effects import terms_of
from ivsid.identification.bias import COEFFICIENT, separate_bias, with_unknowns
from ivsid.rows import ROW_KINDS, build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle

BIASED = """[sensors.acceleration]
random_walk = [0.0018, 0.002]
bias_instability = [0.02, 0.015]
bias_time = [20000.0, 20000.0]"""


def biased(swan, terms='terms = "paper"'):
    start, end = swan.text.index("[sensors.acceleration]"), swan.text.index("[sensors.yaw_rate]")
    text = f"{swan.text[:start]}{BIASED}\n\n{swan.text[end:]}".replace('terms = "paper"', terms)
    return parse_vehicle(text, "biased.toml")


OWN = (
    'terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic", "coupling.cg_y"]'
)
VALUES = {"mass.surge": 60.0, "mass.sway": 75.0, "inertia.yaw": 8.0, "drag.surge.quadratic": 250.0}
VALUES |= {"drag.sway.quadratic": 300.0, "coupling.cg_y": 0.5}


def test_every_kind_of_row_states_what_it_takes_of_a_bias():
    """A kind that takes an acceleration and no unknown would have bounds that are too narrow."""
    assert set(COEFFICIENT) == set(ROW_KINDS)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("form", ["total", "added"])
def test_rows_with_unknown_biases_hold_at_the_truth(swan, programme, seed, form):
    """For the true parameters there are biases inside their bounds that satisfy every row: those of the simulator."""
    vehicle = biased(swan, OWN) if form == "total" else biased(swan)
    truth = VALUES if form == "total" else dict(programme.truth)
    made = simulate(vehicle, programme.model_copy(update={"truth": truth, "duration": 60.0}), seed)
    bounded = bound_log(as_log(made), vehicle)
    narrow, reach = separate_bias(bounded, vehicle, "log")
    terms = terms_of(vehicle, form)
    mass = vehicle.hull.mass if form == "added" else 0.0
    rows = build_rows(narrow, vehicle, terms, added_mass=form == "added")
    extended = with_unknowns(rows, reach, narrow.log, vehicle, mass)
    assert extended.matrix.shape[1] > rows.matrix.shape[1]
    values = {**truth, "added_mass.surge": truth["mass.surge"] - vehicle.hull.mass}
    # The bias in the middle, from the readings themselves: white noise averages out, the bias hardly moves.
    error = {a: float(np.mean(made.columns[n] - made.exact[n])) for a, n in (("x", "ax"), ("y", "ay"))}
    x_g, y_g = vehicle.hull.centre_of_gravity
    theta = []
    for term in extended.terms:
        if not term.id.startswith("bias."):
            theta.append(values[term.id])
            continue
        _, axis, channel = term.id.split(".")
        k = ("surge", "sway", "yaw").index(channel)
        row = extended.matrix[rows.time.size :]
        own = int(np.flatnonzero(row.lower[:, [t.id for t in extended.terms].index(term.id)] == 1.0)[0])
        shares = row.upper[own, : len(terms)] / reach[axis]
        signs = [1.0 if t.id != "coupling.cg_y" else -1.0 for t in terms]
        known = {("x", 2): -vehicle.hull.mass * y_g, ("y", 2): vehicle.hull.mass * x_g}.get((axis, k), 0.0)
        known += mass * (1.0 if (axis, k) in (("x", 0), ("y", 1)) else 0.0)
        theta.append(
            error[axis] * (sum(s * q * values[t.id] for s, q, t in zip(signs, shares, terms, strict=True)) + known)
        )
    residual = extended.matrix @ IntervalArray(np.array(theta)) - extended.right
    assert residual.contains(np.zeros(residual.shape)).all()


@pytest.mark.parametrize("seed", range(3))
def test_a_slow_large_bias_is_worth_an_unknown(swan, programme, seed):
    vehicle = biased(swan)
    made = simulate(vehicle, programme.model_copy(update={"duration": 60.0}), 100 + seed)
    box = identify(vehicle, as_log(made), bias="sample")
    one = identify(vehicle, as_log(made))
    assert one.status == box.status == "enclosed" and one.guaranteed
    assert set(one.parameters) == set(box.parameters) == set(one.estimate)
    assert any("one unknown for the log" in a for a in one.assumes)
    for id_, value in made.truth["parameters"].items():
        assert one.parameters[id_].lower <= value <= one.parameters[id_].upper, id_
    for id_ in ("mass.surge", "drag.surge.quadratic"):
        assert one.parameters[id_].width < 0.8 * box.parameters[id_].width, id_


def test_by_default_a_small_bias_stays_in_its_box(swan, twin):
    assert separate_bias(bound_log(as_log(twin), swan), swan, "auto") is None
    assert separate_bias(bound_log(as_log(twin), swan), swan, "sample") is None
    with pytest.raises(IvsidError, match="bias 'never' is unknown; use auto, sample, log"):
        identify(swan, as_log(twin), bias="never")
