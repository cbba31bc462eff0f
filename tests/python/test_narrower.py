"""Hints of an identification at options that narrow it: each is true of the log that it is given for."""

from dataclasses import replace
from functools import cache
from importlib.resources import files

import numpy as np
import pytest

from ivsid import identify
from ivsid.identification import Parameter, narrower
from ivsid.identification.narrower import beyond
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.first_screens import identified
from ivsid.workflow.identification import identification_report
from ivsid.workflow.parameters import narrower_lines
from test_physical import TRUTH, subject

SIGN_OPEN = ("vectored_rov", "otter")
# The linear programmes of the Otter's physical bounds take some seconds.
OPEN = ("vectored_rov", pytest.param("otter", marks=pytest.mark.nightly))


@cache
def made(name):
    """A shipped vehicle, its fit, its log and what would narrow the fit."""
    scenario = "swan_train" if name == "swan" else f"{name}_programme"
    texts = [(files("ivsid") / "data" / f"{n}.toml").read_text() for n in (name, scenario)]
    vehicle = parse_vehicle(texts[0], name)
    moved = parse_scenario(texts[1], scenario)
    run = simulate(vehicle, moved, 3)
    log = Log("log.csv", "0" * 64, run.t, dict(run.columns))
    fit = identify(vehicle, log, examine=False)
    return fit, log, narrower(fit, log)


@pytest.mark.parametrize("name", ["swan", *OPEN])
def test_hints_stand_where_the_sign_of_a_parameter_is_open(name):
    fit, _, more = made(name)
    assert any(p.lower < 0 < p.upper for p in fit.parameters.values()) == (name in SIGN_OPEN) == more.asked
    assert bool(narrower_lines(more)) == more.asked


@pytest.mark.parametrize("name", OPEN)
def test_the_options_of_a_hint_narrow_what_it_names(name):
    """Other parameters may be narrowed, too; those that are named have to be."""
    fit, log, more = made(name)
    rows = identify(fit.vehicle, log, rows="both", window=more.windows, examine=False)
    for id_, p in more.parameters.items():
        old, new = fit.parameters[id_], rows.parameters[id_]
        assert (new.lower, new.upper) == (p.lower, p.upper)
        assert new.width <= 0.75 * old.width
    physical = identify(fit.vehicle, log, physical=True, examine=False)
    assert more.beyond
    for id_ in more.beyond:
        old, new = fit.parameters[id_], physical.parameters[id_]
        assert new.lower > old.lower or new.upper < old.upper


@pytest.mark.parametrize("name", ["swan", *OPEN])
def test_the_terminal_and_the_first_screen_say_the_same(name):
    fit, log, more = made(name)
    said = narrower_lines(more)
    report = identification_report(fit, log, more)
    assert all(f"  {line}" in report.lines for line in said)
    assert [s for s in identified(fit, said).following if s in said] == said
    assert sum("--physical" in line for line in report.lines) == int(bool(more.beyond))


def test_more_windows_are_named_with_what_they_give():
    """Windows average the noise of the yaw acceleration; where they narrow nothing clearly, nothing is said of them."""
    more = made("vectored_rov")[2]
    first, *rest = narrower_lines(more)
    assert first.startswith("narrower by --rows both --window 0.5,2,10, which adds rows") and "inertia.yaw [" in first
    assert narrower_lines(replace(more, parameters={})) == rest and not any("--rows both" in line for line in rest)


@pytest.mark.nightly
def test_windows_that_narrow_nothing_are_not_named():
    more = made("otter")[2]
    assert more.tried and not more.parameters and not any("--rows both" in line for line in narrower_lines(more))


def test_the_physical_bounds_are_named_for_ends_of_no_vessel_alone():
    """Mass 50 kg: totals lie between 25 and 500 kg; a drag may not drive."""
    whole = {k: Parameter(0.9 * x, 1.1 * x, "", "") for k, x in TRUTH.items()}
    assert beyond(subject(), whole) == ()
    for id_, lower, upper in (
        ("mass.surge", 24.9, 60.0),
        ("mass.sway", 70.0, 501.0),
        ("inertia.yaw", -0.1, 9.0),
        ("inertia.yaw", 8.0, np.inf),
        ("drag.sway.quadratic", -1.0, 160.0),
        ("drag.surge.quadratic", -np.inf, 30.0),
    ):
        assert beyond(subject(), {**whole, id_: Parameter(lower, upper, "", "")}) == (id_,)
    assert beyond(subject(), {**whole, "drag.surge.quadratic": Parameter(1.0, np.inf, "", "")}) == ()


def test_nothing_is_tried_on_a_long_log_and_on_rows_that_are_taken_already():
    fit, log, more = made("vectored_rov")
    again = identify(fit.vehicle, log, rows="both", window=(0.5, 2.0), physical=True, examine=False)
    assert not narrower(again, log).asked
    rows = identify(fit.vehicle, log, rows="both", window=(0.5, 2.0, 10.0), examine=False)
    taken = narrower(rows, log)
    assert taken.asked and not taken.tried and not taken.parameters and taken.beyond
    count = 20_001
    long = Log("long.csv", "0" * 64, 0.05 * np.arange(count), {k: np.resize(x, count) for k, x in log.columns.items()})
    found = narrower(fit, long)
    assert found.asked and not found.tried
    assert narrower_lines(found) and "too long" in narrower_lines(found)[0]
    assert more.tried
