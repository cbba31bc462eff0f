"""The extended model goes back into the simulator: what a diagnosis writes, the other commands read."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import TRUTH, logs_of, train_of, vehicle_of
from ivsid import IvsidError, diagnose, identify, validate, verify
from ivsid.diagnosis import extended_vehicle
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.statements.extended import extended_text
from ivsid.effects import EFFECTS, PAPER_TERMS, PLAIN_TERMS, Given, fitted, sort_given, with_terms
from ivsid.programme.scenario import Start, parse_scenario
from ivsid.simulation import follow, simulate
from ivsid.vehicle import parse_vehicle

SCENARIO = """
duration = 12.0
rate = 10.0
seed = 3
[environment]
depth = 4.0
{environment}
[[segments]]
manoeuvre = "steps"
demand = [60.0, -40.0, 20.0]
differential = 12.0
period = 4.0
duration = 12.0
"""
MEASURED = "wind_speed = 4.0\nwind_direction = 1.0\nvoltage = 24.0\nvoltage_fall = 0.02\n"
# An effect of time begins inside the short programme.
START = 5.0
FORMS = [(id_, form) for id_, e in EFFECTS.items() for form in (e, e.measured) if form is not None]


def value_of(form):
    """A number for each parameter of an effect, sizes as in the catalogue."""
    if form.plain:
        return (TRUTH[form.id] * 1.1,)
    return tuple(START if p.draw == "time" else p.typical * (0.5 if p.inverse else 1.3) for p in form.parameters)


def hypothesis(vehicle, given, wanted=PLAIN_TERMS, truth=TRUTH):
    """The plain model with an effect in it, as a diagnosis holds it."""
    numbers = {**truth, **{n: v for g in given for n, v in g.named.items()}}
    terms = with_terms(vehicle, wanted, given)
    beside = tuple(g for g in given if not g.effect.terms)
    return Hypothesis(terms, {t.id: numbers[t.id] for t in terms}, beside)


def both(vehicle, given, *, measured=False, wanted=PLAIN_TERMS, truth=TRUTH):
    """Columns of the model that is written and read, and of the effect given beside the plain model."""
    scenario = parse_scenario(SCENARIO.format(environment=MEASURED if measured else ""), "s.toml")
    text = extended_text(vehicle, hypothesis(vehicle, given, wanted, truth))
    numbers = {n: v for g in given for n, v in g.named.items()}
    direct = simulate(vehicle, scenario, effects={**truth, **numbers})
    return simulate(parse_vehicle(text, "model.toml"), scenario).columns, direct.columns


def test_the_catalogue_has_47_effects():
    assert len(EFFECTS) == 47 and len(FORMS) == 49


@pytest.mark.parametrize(("id_", "form"), FORMS, ids=[f"{i}-{'.'.join(q.part for q in f.parameters)}" for i, f in FORMS])
def test_an_effect_that_is_written_and_read_moves_the_vehicle_as_the_effect_itself(id_, form):
    vehicle = vehicle_of()
    given = (Given(form, value_of(form)),)
    measured = form is not EFFECTS[id_]
    written, direct = both(vehicle, given, measured=measured)
    assert written.keys() == direct.keys()
    for name, column in direct.items():
        # A share that is left, 1 - x, rounds once.
        np.testing.assert_allclose(written[name], column, rtol=1e-12, atol=1e-12, err_msg=name)
    plain = simulate(vehicle, parse_scenario(SCENARIO.format(environment=MEASURED if measured else ""), "s.toml"), effects=TRUTH)
    assert any(not np.allclose(plain.columns[n], column, rtol=1e-9, atol=1e-9) for n, column in direct.items())
