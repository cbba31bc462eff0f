"""Every form of [model.fitted] through simulate, identify, validate and verify: the truth is inside, or the result says what it leaves out."""

import polars as pl
import pytest

from diagnosis_logs import TRUTH, vehicle_of
from ivsid import identify, validate, verify
from ivsid.diagnosis.statements.extended import extended_text
from ivsid.effects import EFFECTS, Given
from ivsid.log import read_log
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from test_extended_model import FORMS, MEASURED, SCENARIO, hypothesis, value_of

# Forms that no interval row holds: their rows are those of a model without them, and prove nothing.
LEFT_OUT = {
    "drag.surge.hump",
    "payload.step",
    "current.oscillating",
    "wave.force",
    "environment.shallow_water",
    "tether.tension",
    "fouling.drift",
    "thruster.failure",
    "thruster.voltage_sag",
    "thruster.curve",
    "sensor.attitude_leak",
    "sensor.velocity.delay",
}
LIMITS = "\n[sensors.limits]\nacceleration = 3.0\nyaw_acceleration = 3.0\n"
# One of each kind in the gate: a term of yaw, a cause that is carried, and one that is left out.
GATE = ("drag.yaw.cubic", "thruster.delay", "wave.force")


def cases():
    for id_, form in FORMS:
        marks = [] if id_ in GATE else [pytest.mark.nightly]
        yield pytest.param(id_, form, id=f"{id_}-{'.'.join(q.part for q in form.parameters)}", marks=marks)


@pytest.mark.parametrize(("id_", "form"), [*cases()])
def test_a_form_goes_through_every_command(tmp_path, id_, form):
    given = (Given(form, value_of(form)),)
    measured = form is not EFFECTS[id_]
    vehicle = parse_vehicle(extended_text(vehicle_of(), hypothesis(vehicle_of(), given)) + LIMITS, "model.toml")
    scenario = parse_scenario(SCENARIO.format(environment=MEASURED if measured else ""), "s.toml")
    paths = [tmp_path / f"run{seed}.csv" for seed in (3, 4)]
    for seed, path in zip((3, 4), paths, strict=True):
        made = simulate(vehicle, scenario.model_copy(update={"seed": seed}))
        pl.DataFrame({"t": made.t, **made.columns}).write_csv(path)
    fit = identify(vehicle, read_log(paths[0], vehicle.log))
    left_out = any("of [model.fitted], which no interval row can hold" in note for note in fit.notes)
    assert left_out == (id_ in LEFT_OUT or measured)
    assert fit.guaranteed != left_out
    truth = {**TRUTH, **{n: v for g in given for n, v in g.named.items()}}
    if not left_out:
        assert fit.status in ("enclosed", "unbounded")
        assert all(p.lower <= truth[k] <= p.upper for k, p in fit.parameters.items())
    checked = validate(fit, read_log(paths[1], vehicle.log), tubes=False)
    assert left_out or not any(f.falsified for f in checked.forces)
    fit.save(tmp_path / "fit")
    assert verify(tmp_path / "fit", paths[0]).proved
