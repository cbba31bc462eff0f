"""Which column is missing for which parameter."""

import numpy as np
import pytest

from ivsid import IvsidError, identify
from ivsid.effects import CATALOGUE, CHANNELS, State, on_hull, terms_of
from ivsid.log import Log
from ivsid.rows.required_columns import needed_by
from ivsid.vehicle import parse_vehicle

HEAD = 'name = "a"\n[hull]\nmass = 3\n'
QUANTITIES = ("u", "v", "r", "udot", "vdot", "rdot")


@pytest.mark.parametrize("id_", list(CATALOGUE))
def test_what_a_term_needs_against_its_own_numbers(id_):
    """A quantity is needed where moving it moves a column; found here by numbers, in the package by names."""
    rng = np.random.default_rng(0)
    vehicle = parse_vehicle(HEAD.replace("mass = 3", "mass = 3\nlength = 1.2"), "a.toml")
    term = on_hull(CATALOGUE[id_], vehicle)
    moved = set()
    for _ in range(20):
        base = dict(zip(QUANTITIES, rng.uniform(-1, 1, 6), strict=True))
        for name in QUANTITIES:
            other = {**base, name: base[name] + 0.37}
            before, after = term.columns(State(**base)), term.columns(State(**other))
            if any(before.get(c, 0.0) != after.get(c, 0.0) for c in CHANNELS):
                moved.add(name.removesuffix("dot"))
    wanted = {c for c in needed_by([term], vehicle) if c in ("u", "v", "r")}
    assert wanted == moved


def test_the_sentence_names_every_missing_column_with_its_parameters():
    vehicle = parse_vehicle(
        HEAD + '[[thrusters]]\nname = "port"\ngain = 1\n[[thrusters]]\nname = "bow"\ngain = 1\nazimuth = 1.57\n',
        "a.toml",
    )
    t = np.arange(10.0)
    log = Log("run.csv", "", t, {"u": t, "v": t, "demand_port": t})
    with pytest.raises(IvsidError) as caught:
        identify(vehicle, log)
    words = str(caught.value)
    assert words.startswith("run.csv cannot serve: it has no column ") and "\n" not in words
    assert "r (needed for mass.surge, mass.sway, inertia.yaw)" in words
    assert (
        "demand_bow (the demand of thruster bow, needed for mass.surge, mass.sway, inertia.yaw, drag.surge.quadratic and 1 more)"
        in words
    )
    assert "it has u, v, demand_port: add what is missing" in words


def test_a_term_that_turns_with_the_vehicle_needs_the_heading():
    vehicle = parse_vehicle(HEAD + '[model]\nterms = ["mass.surge", "wind.steady"]\n', "a.toml")
    wanted = needed_by(terms_of(vehicle), vehicle)
    assert wanted["psi"] == ("wind.steady.north", "wind.steady.east") and "x" not in wanted
