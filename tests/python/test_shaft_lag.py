"""A shaft that follows its demand late, where the thrust goes with the square of its speed; and the size of a limit by the file's own thrust."""

import numpy as np
import pytest

from diagnosis_logs import TABLE, TWIN, logs_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis import isolability
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.profile import SHARES, bracketed
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.declared_errors import through_water, thrust_answers
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.curve_errors import curve_errors
from ivsid.diagnosis.plant.propulsion import Propulsion
from ivsid.diagnosis.plant.thrust_errors import bound_of
from ivsid.effects import EFFECTS, Given

SQUARE = "quadratic = { forward = 0.004, reverse = 0.003 }\ndemand_range = [-100, 100]"
LAG = 0.5
STEPS = """
[[segments]]
manoeuvre = "steps"
demand = [30.0, 80.0]
period = 6.0
duration = 24.0
"""


def squared():
    return vehicle_of(TWIN.replace(TABLE, SQUARE))


def test_the_thrust_is_that_of_the_lagged_speed_in_the_diagnosis():
    vehicle = squared()
    log = channels(logs_of(vehicle, duration=70.0)[0], vehicle)
    effect = EFFECTS["thruster.shaft_lag"]
    thrusts = Propulsion(vehicle, log).thrusts((Given(effect, (LAG,)),))
    of_thrust = Propulsion(vehicle, log).thrusts((Given(EFFECTS["thruster.lag"], (LAG,)),))
    n = 0.0
    want = []
    for d in log.demands[0]:
        want.append((0.004 if n > 0 else 0.003) * n * abs(n))
        n = d + (n - d) * np.exp(-log.h / LAG)
    # The shaft starts at the first demand in the diagnosis; what is left of that after six time constants is nothing.
    later = round(30 * LAG / log.h)
    np.testing.assert_allclose(thrusts.now[0][later:], want[later:], atol=1e-6)
    assert np.abs(thrusts.now - of_thrust.now)[0][later:].max() > 1.0


@pytest.mark.parametrize("lag", [0.005, 0.03, 0.1, 0.4, 2.0])
def test_the_mean_over_a_step_is_that_of_the_thrust_on_its_way(lag):
    """The oracle steps the shaft's speed 2,000 times in each step of the clock; at a lag of one step the thrust of the mean speed is off by a twentieth."""
    vehicle = squared()
    log = channels(logs_of(vehicle, duration=70.0)[0], vehicle)
    mean = Propulsion(vehicle, log).thrusts((Given(EFFECTS["thruster.shaft_lag"], (lag,)),)).mean[0]
    fine = (np.arange(2000) + 0.5) / 2000 * log.h
    n, want, straight = log.demands[0][0], [], []
    for d in log.demands[0]:
        speed = d + (n - d) * np.exp(-fine / lag)
        want.append(np.mean(np.where(speed > 0, 0.004, 0.003) * speed * np.abs(speed)))
        straight.append(np.ptp(np.sign(speed)) == 0)
        n = d + (n - d) * np.exp(-log.h / lag)
    # Where the speed passes zero the curve bends: a hundredth of the largest thrust of 40 N.
    np.testing.assert_allclose(mean, want, atol=0.4)
    np.testing.assert_allclose(mean[straight], np.array(want)[straight], atol=1e-4)
    assert np.sum(straight) > 0.9 * mean.size


def test_a_sound_vessel_whose_shafts_lag_by_a_sample_has_no_lag_to_find():
    """The shipped Otter at 10 Hz: its own lag of 0.1 s was named once more, at 11 standard deviations."""
    from ivsid.diagnosis.candidates.families import everything, score
    from ivsid.diagnosis.estimation.learning import plain_fit
    from ivsid.files.shipped import shipped
    from ivsid.log import Log
    from ivsid.programme.scenario import read_scenario
    from ivsid.simulation import simulate
    from ivsid.vehicle import read_vehicle

    vehicle = read_vehicle("otter")
    made = simulate(vehicle, read_scenario(shipped("example", "_programme")), 1)
    _, found = score(plain_fit(vehicle, channels(Log("run", "", made.t, made.columns), vehicle), everything))
    assert max(s.fall for s in found if s.id in ("thruster.lag", "thruster.shaft_lag", "thruster.delay")) < 20.0


def test_a_file_that_says_so_makes_the_two_lags_one():
    said = vehicle_of(TWIN.replace(TABLE, SQUARE + '\nlag = "demand"'))
    log = channels(logs_of(said, duration=70.0)[0], said)
    one, two = (
        Propulsion(said, log).thrusts((Given(EFFECTS[i], (LAG,)),)) for i in ("thruster.lag", "thruster.shaft_lag")
    )
    np.testing.assert_array_equal(one.mean, two.mean)


# Nightly: whole diagnoses; the gate screens a lag first in test_diagnosis_stages.py.
@pytest.mark.nightly
@pytest.mark.parametrize("id_", ["thruster.shaft_lag", "thruster.lag"])
def test_a_lag_is_named_and_told_from_the_other_by_a_curve_that_bends(id_):
    vehicle = squared()
    found = diagnose(vehicle, *logs_of(vehicle, {id_: LAG}, duration=160.0), null_logs=0).findings
    assert [f.effect for f in found] == [id_] and not found[0].alternatives
    (bound,) = found[0].parameters.values()
    assert bound.lower < LAG < bound.upper and bound.upper - bound.lower < 0.2 * LAG


def test_the_typical_limit_of_a_thrust_is_that_of_the_file():
    """Vehicles of one mass with other thrusters: Froude's law would give both the same limit."""
    parameter = EFFECTS["thruster.saturation"].parameters[0]
    assert parameter.scaled(58.0, 90.0) == pytest.approx(60.0) and parameter.scaled(58.0) == 30.0
    sizes = {}
    for factor in (1.0, 3.0):
        text = TWIN.replace(TABLE, SQUARE.replace("0.004", str(0.004 * factor)).replace("0.003", str(0.003 * factor)))
        vehicle = vehicle_of(text)
        result = isolability(vehicle, logs_of(vehicle, duration=70.0)[0])
        (sizes[factor],) = result.visible["thruster.saturation"].typical.values()
    assert sizes[1.0] == pytest.approx(40.0 * 2 / 3) and sizes[3.0] == pytest.approx(120.0 * 2 / 3)


def test_a_value_ten_times_the_first_is_reached_from_the_shares():
    """The score of a short lag says little of a long one: values are followed outward while chi-squared falls, either way, and no further."""
    asked = []

    def chi2(value, least):
        asked.append(value)
        return np.log(value / least) ** 2

    for least in (0.14, 2e-4):
        tried = {0.008 * share: chi2(0.008 * share, least) for share in SHARES}
        asked.clear()
        found = bracketed(lambda x: chi2(x, least), tried)  # noqa: B023 - called at once
        assert found == pytest.approx(least, rel=0.1)
        assert len(asked) <= np.ceil(abs(np.log(least / 0.008)) / np.log(SHARES[1] / SHARES[0]))
    inside = {0.1: 2.0, 0.2: 1.0, 0.4: 3.0}
    asked.clear()
    assert bracketed(lambda x: chi2(x, 1.0), inside) == 0.2 and not asked


@pytest.mark.parametrize("late", ["demand", "thrust"])
def test_cells_hold_all_demands_that_a_late_shaft_runs_through(late):
    """A step jumps over demands that the shaft runs through, where the error of its thrust may jump: 11 of 400 sound logs looked like a limit."""
    text = TWIN.replace(TABLE, f'{SQUARE}\ntime_constant = {LAG}\nlag = "{late}"')
    vehicle = vehicle_of(text)
    fit = plain_fit(vehicle, channels(logs_of(vehicle, segments=STEPS, duration=70.0)[0], vehicle), everything)
    s, made = fit.signatures, dict(curve_errors(fit))
    predictor = s.predictor
    port = [v for n, v in made.items() if n.startswith("~cell.port.")]

    def bound(d):
        return bound_of(vehicle.thrusters[0], predictor.propulsion.curves[0], d)[None]

    relative = through_water(s)
    (whole,) = thrust_answers(s, 0, predictor.driving.slopes(s.h, 0, bound), relative)
    np.testing.assert_allclose(np.sum(port, axis=0), whole, atol=1e-9 * np.abs(whole).max())
    # Two levels are sent; a thrust that lags has the errors of these alone.
    assert len(port) > 20 if late == "demand" else len(port) <= 4
