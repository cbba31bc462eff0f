"""Null logs: that they are the log's own programme without an effect, that their scores are those that the Gaussian draws promise."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.kinds.linear import LinearCandidate
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null import calibration, closed_loop, simulated_logs
from ivsid.diagnosis.null.calibration import examined, trial_of
from ivsid.diagnosis.null.closed_loop import not_followed
from ivsid.diagnosis.null.examination import Families
from ivsid.diagnosis.null.family_wise import Threshold
from ivsid.diagnosis.null.looks import Looks
from ivsid.diagnosis.null.simulated_logs import SLOWEST, null_logs, thinned
from ivsid.diagnosis.null.thresholds import calibrate
from ivsid.diagnosis.null.visibility import visibility
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.diagnosis.selection.confirmation import CLOSE, StructureTest, confirmed, sound, strength
from ivsid.diagnosis.selection.rivals import Found
from ivsid.effects import EFFECTS, Given, sort_given
from ivsid.log import Log
from ivsid.programme.scenario import parse_scenario
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.simulation import simulate
from ivsid.simulation.equations import equations, plant
from ivsid.vehicle import parse_vehicle
from sampling import spaced

STRAIGHT = """
[[segments]]
manoeuvre = "steps"
demand = [40.0, 60.0, 25.0, 70.0]
period = 6.0
yaw_gain = 25.0
duration = 60.0
"""
OPEN = """
[[segments]]
manoeuvre = "prbs"
demand = 40.0
amplitude = 20.0
differential = 6.0
period = 3.0
duration = 60.0
"""


def drawn(segments=ZIGZAGS, rate=10.0, duration=240.0, seed=5):
    vehicle = parse_vehicle(TWIN + SENSORS, "twin.toml")
    head = f"duration = {duration}\nrate = {rate}\nseed = {seed}\n[truth]\n"
    head += "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
    done = simulate(vehicle, parse_scenario(head + segments, "s.toml"), seed)
    return vehicle, Log("a.csv", "0" * 64, done.t, done.columns)


def trial(segments=ZIGZAGS, **kwargs):
    vehicle, log = drawn(segments, **kwargs)
    fit = plain_fit(vehicle, channels(log, vehicle), everything)
    visible = visibility(fit)
    seen = frozenset(i for i, v in visible.items() if v.tested)
    test = Threshold(calibrate(fit, seen, 0.005, 1), visible)
    return fit, test, trial_of(fit, test.visible, Families(test))


@pytest.fixture(scope="module")
def zigzags():
    return trial()


def test_waves_and_tethers_are_searched_once_for_the_noise():
    """The round before learns the strength of the ambient force alone, and a search takes a third of it."""
    vehicle, log = drawn(duration=90.0)
    searched = []

    def search(fit):
        searched.append(fit)
        return everything(fit)

    plain_fit(vehicle, channels(log, vehicle), search)
    assert len(searched) == 1


def test_the_whitening_is_learnt_once_however_many_parts_null_logs_are_made_in(zigzags, monkeypatch):
    """The null logs that teach it depend on the seed alone; learning it again cost as much as two of them a part."""
    made = []

    def noted(programme, seed, numbers):
        made.append(list(numbers))
        return null_logs(programme, seed, numbers)

    monkeypatch.setattr(calibration, "null_logs", noted)
    found = list(zigzags[2].strengths(3, [range(2), range(2, 4)]))
    assert [k >= calibration.APART for k in made[0]] == [True, True, False, False] and made[1] == [2, 3]
    assert found == list(zigzags[2].strengths(3, [range(4)]))


def test_the_feedback_of_a_log_is_found_with_its_gain(zigzags):
    back = zigzags[2].programme.feedback
    # Port first: it is given less when the yaw rate is asked for more; the segments have gains of 20 and 25.
    assert back.feedback_gains[0, 2] == pytest.approx(-24, abs=2) and back.feedback_gains[1, 2] == pytest.approx(
        24, abs=2
    )
    assert not back.feedback_gains[:, [0, 1, 3]].any() and not back.feedback_gains[2:].any()
    assert 0.5 < back.at[0].mean() < 1.0 and not back.reads


# Nightly: two more trials; the gate finds the feedback of the zigzags.
@pytest.mark.nightly
def test_a_straight_course_shows_its_feedback_through_the_noise_and_an_open_loop_has_none():
    straight = trial(STRAIGHT)[2].programme.feedback
    assert straight.feedback_gains[1, 2] == pytest.approx(25, rel=0.2) and straight.at[1].mean() > 0.8
    assert not trial(OPEN)[2].programme.feedback.closed


@pytest.mark.parametrize("logged", [(False, False), (False, True)])
def test_without_noise_a_null_log_moves_as_the_equations_say(logged, zigzags):
    """The rates at each sample are those of the simulator's own equations, as specific forces or as they are, and the next state is their integral."""
    programme = zigzags[2].programme
    quiet = replace(
        programme,
        ambient=replace(programme.ambient, deviation=(0.0, 0.0, 0.0)),
        declared_errors={},
        log=replace(programme.log, noise=dict.fromkeys(programme.log.noise, 0.0), rates=logged),
    )
    log, h = null_logs(quiet, 1, [0])[0]
    vehicle = programme.vehicle
    numbers = {k: float(v) for k, v in h.values.items()}
    model = plant(vehicle, h.terms, sort_given(numbers, [t.name for t in vehicle.thrusters]))
    rates = equations(model)
    curves = [ThrustCurve(t.model_copy(update={"outside": "hold"})) for t in vehicle.thrusters]
    for i in range(0, log.n, 37):
        push = [float(c.value(log.demands[k, i])) for k, c in enumerate(curves)]
        state = (*log.nu[:, i], log.psi[i], *log.place[:, i])
        found = rates(log.t[i], *state, 0.0, 0.0, 0.0, 0.0, 0.0, *push, 0.0, 0.0)
        u, v, r = log.nu[:, i]
        assert log.acceleration[0][i] == pytest.approx(found[0] - v * r, abs=2e-5)
        assert log.acceleration[1][i] == pytest.approx(found[1] + (0.0 if logged[1] else u * r), abs=2e-5)


# Nightly: masses that change are solved at each step; the gate compares the plain model's with the equations.
@pytest.mark.nightly
def test_null_logs_of_a_model_with_causes_follow_them(zigzags):
    """Rates at samples are those of the simulator's own thrust curve with a dead band, under masses that grow at a moment."""
    programme = zigzags[2].programme
    band, added, moment = 15.0, 6.0, 0.5 * float(programme.log.t[-1])
    h = programme.h.with_effect(Given(EFFECTS["thruster.deadband"], (band,)))
    h = h.with_effect(Given(EFFECTS["payload.step"], (added, moment)))
    assert not_followed(h) == ()
    quiet = replace(
        programme,
        h=h,
        ambient=replace(programme.ambient, deviation=(0.0, 0.0, 0.0)),
        declared_errors={},
        log=replace(programme.log, noise=dict.fromkeys(programme.log.noise, 0.0)),
    )
    log, true = null_logs(quiet, 1, [0])[0]
    vehicle = programme.vehicle
    numbers = {k: float(v) for k, v in true.values.items()}
    numbers |= {"thruster.deadband": band, "payload.step.mass": added, "payload.step.time": moment}
    model = plant(vehicle, true.terms, sort_given(numbers, [t.name for t in vehicle.thrusters]))
    rates = equations(model)
    curves = [ThrustCurve(t.model_copy(update={"outside": "hold", "dead_band": band})) for t in vehicle.thrusters]
    # Demands inside the band, whose thrust is none.
    assert (np.abs(log.demands) < band).any()
    for i in range(0, log.n, 37):
        push = [float(c.value(log.demands[k, i])) for k, c in enumerate(curves)]
        found = rates(log.t[i], *log.nu[:, i], log.psi[i], *log.place[:, i], 0.0, 0.0, 0.0, 0.0, 0.0, *push, 0.0, 0.0)
        u, v, r = log.nu[:, i]
        assert log.acceleration[0][i] == pytest.approx(found[0] - v * r, abs=2e-4)
        assert log.acceleration[1][i] == pytest.approx(found[1] + u * r, abs=2e-4)


# Nightly: another fit; the gate has no log with rare velocities whose null logs are simulated.
@pytest.mark.nightly
def test_null_logs_follow_demands_that_come_faster_than_the_velocities():
    """Without noise the errors of the true model are far below the noise of the sensors; with demands held over a step they were five times it."""
    vehicle, log = drawn(duration=90.0)
    rare = np.arange(log.t.size) % 4 == 0
    columns = {k: np.where(rare, x, np.nan) if k in ("u", "v") else x for k, x in log.columns.items()}
    fit = plain_fit(vehicle, channels(Log("a.csv", "0" * 64, log.t, columns), vehicle), everything)
    data = fit.noise.predictor.log
    assert data.between is not None and data.between.demands.shape[2] == 4
    programme = trial_of(fit, frozenset(), StructureTest()).programme
    quiet = replace(
        programme,
        ambient=replace(programme.ambient, deviation=(0.0, 0.0, 0.0)),
        declared_errors={},
        log=replace(programme.log, noise=dict.fromkeys(programme.log.noise, 0.0)),
    )
    one, true = null_logs(quiet, 1, [0])[0]
    # The filter of a yaw rate and a heading at a slow clock warns of a root of rounding.
    with np.errstate(invalid="ignore"):
        predictor = Predictor(vehicle, one, fit.noise.predictor.ambient)
        errors = predictor.errors(predictor.settle(predictor.start(true), 6))
    for row, (_, name) in enumerate(predictor.labels):
        assert np.sqrt(np.mean(errors[row] ** 2)) < 0.5 * data.noise[name]


def test_a_motion_that_diverges_is_lost_and_no_error(zigzags):
    """Its feedback asks for a demand that is no number, which was no place in a thrust curve."""
    programme = zigzags[2].programme
    thrusters = closed_loop._Thrusters(programme, [None for _ in programme.vehicle.thrusters], 2)
    demand = float(programme.log.demands[0].max())
    lost, sound = thrusters.static(0, np.array([np.nan, demand]))
    assert np.isnan(lost) and sound == pytest.approx(
        float(ThrustCurve(programme.vehicle.thrusters[0]).value(demand)), rel=1e-3
    )


# Nightly: three more null logs; the gate compares each with the equations.
@pytest.mark.nightly
def test_a_null_log_is_the_same_alone_and_in_company(zigzags):
    programme = zigzags[2].programme
    alone, together = null_logs(programme, 3, [4])[0][0], null_logs(programme, 3, [2, 4])[1][0]
    for name in ("nu", "psi", "place", "demands"):
        np.testing.assert_array_equal(getattr(alone, name), getattr(together, name))
    other = null_logs(programme, 4, [4])[0][0]
    assert not np.array_equal(alone.nu, other.nu)


def test_null_logs_have_the_noise_of_the_log_and_its_demands_where_no_feedback_acts(zigzags):
    fit, _, made = zigzags
    log, _ = null_logs(made.programme, 1, [0])[0]
    real, thin = fit.noise.predictor.log, made.programme.log
    still, _ = null_logs(replace(made.programme, log=replace(thin, noise=dict.fromkeys(thin.noise, 0.0))), 1, [0])[0]
    for k, name in enumerate(("u", "v", "r")):
        # A sample of the slower clock stands for the mean of two.
        assert np.std(log.nu[k] - still.nu[k]) == pytest.approx(real.noise[name] / np.sqrt(2), rel=0.1)
    rest = ~made.programme.feedback.at[0]
    np.testing.assert_array_equal(log.demands[0, rest], thin.demands[0, rest])


def test_thrust_errors_of_null_logs_are_of_every_kind_and_inside_their_bound(zigzags):
    programme = zigzags[2].programme
    rngs = [np.random.default_rng([1, k]) for k in range(60)]
    _, curves = simulated_logs._declared_errors(programme, rngs)
    thruster, (low, high) = programme.vehicle.thrusters[0], closed_loop.ends(programme)
    demand = np.linspace(low[0], high[0], curves[0].shape[1])
    thrust = np.abs(
        np.interp(demand, np.linspace(-100, 100, 4001), ThrustCurve(thruster).value(np.linspace(-100, 100, 4001)))
    )
    bound = thruster.accuracy.absolute + thruster.accuracy.relative * thrust
    assert (np.abs(curves[0]) <= bound * 1.01 + 1e-3).all()
    share = curves[0][:, bound > 0.05] / bound[bound > 0.05]
    jumps = np.abs(np.diff(share, axis=1)).max(axis=1) > 0.05
    bends = np.abs(np.diff(share, 2, axis=1)).max(axis=1) > 2e-4
    # A third each; of some the corners and jumps stand where no demand was sent.
    assert jumps.sum() >= 8 and (bends & ~jumps).sum() >= 8 and (~bends & ~jumps).sum() >= 15


def test_a_faster_log_is_thinned_and_its_noise_with_it():
    vehicle, log = drawn(rate=20.0, duration=120.0)
    data = channels(log, vehicle)
    thin, q = thinned(data, vehicle)
    assert q == 2 and 1 / thin.h == pytest.approx(SLOWEST) and thin.n == data.n // 2
    assert thin.noise["u"] == pytest.approx(data.noise["u"] / np.sqrt(2))
    inside = data.between.demands[:, : 2 * thin.n].reshape(len(data.demands), thin.n, -1)
    np.testing.assert_allclose(thin.demands, inside.mean(axis=2))
    assert thinned(thin, vehicle) == (thin, 1)
    # Where a demand moves inside a step, the clock stays quicker; demands are those of the whole step there, too.
    quick, q = thinned(replace(data, held=False), vehicle)
    assert q == 1 and quick.between is None and quick.n == data.n
    # A log whose velocities come rarely keeps the demands between them.
    rare = replace(data, held=False, between=replace(data.between, read=(0,)))
    assert thinned(rare, vehicle) == (rare, 1)


def test_a_thinned_clock_adds_no_error_to_a_null_log(zigzags):
    """Without noise the errors of the true model stay far below the noise, on the log's clock too: predictions by the middles of its steps left a tenth."""
    programme = zigzags[2].programme
    assert programme.thinned
    quiet = replace(
        programme,
        ambient=replace(programme.ambient, deviation=(0.0, 0.0, 0.0)),
        declared_errors={},
        log=replace(programme.log, noise=dict.fromkeys(programme.log.noise, 0.0)),
    )
    worst = []
    for thinned_ in (True, False):
        one, true = null_logs(replace(quiet, thinned=thinned_), 1, [0])[0]
        predictor = Predictor(programme.vehicle, replace(one, noise=programme.log.noise), programme.ambient)
        errors = predictor.errors(predictor.settle(predictor.start(true), 6))[:, 40:]
        size = [programme.log.noise[name] for _, name in predictor.labels]
        worst.append(float(np.max(np.sqrt(np.mean(errors**2, axis=1)) / size)))
    assert max(worst) < 0.015


def test_a_demand_beyond_the_means_of_the_programme_is_no_saturation(zigzags):
    """On a thinned clock demands are means, and the feedback may send what the log was sent."""
    programme = zigzags[2].programme
    means = replace(programme.log, demands=0.8 * programme.log.demands)
    thrusters = closed_loop._Thrusters(replace(programme, log=means), [None for _ in means.demands], 1)
    highest = programme.feedback.highest[: len(means.demands)]
    for k, t in enumerate(programme.vehicle.thrusters):
        expected = float(ThrustCurve(t).value(highest[k]))
        assert thrusters.static(k, highest[k : k + 1])[0] == pytest.approx(expected, rel=1e-3)


@pytest.mark.sampled
def test_simulated_and_gaussian_strengths_agree(zigzags):
    """Medians and upper quarters of the largest strength, within what twenty logs can say, or forty in the nightly run."""
    _, test, made = zigzags
    count = len(spaced(range(40), 20))
    found = examined(made, 1, range(count))
    assert found.usable and found.kept.size == count
    drawn_ones = -np.log(np.maximum(test.calibration.smallest, 1e-300))
    for share, most in ((0.5, 1.0), (0.75, 1.5)):
        assert abs(np.quantile(found.kept, share) - np.quantile(drawn_ones, share)) < most
    assert found.passed.sum() <= count // 20
    record = found.record()
    assert record["logs"] == count and record["achieved"] == found.passed.mean()


def close(fit, test, times):
    """A finding of so many times the strength that the threshold asks for."""
    best = next(
        s for s in score(fit)[1] if s.count == 1 and s.id in test.visible and isinstance(s.candidate, LinearCandidate)
    )
    gain = next(
        g
        for g in np.arange(1.0, 500.0, 0.25)
        if strength(test, Found(best.id, (), (), g, 1.0, best)) >= times * asked(test)
    )
    return Found(best.id, (), (), float(gain), 1.0, best)


def asked(test):
    return -float(np.log(test.calibration.chance))


def test_only_a_finding_close_to_its_threshold_asks_for_null_logs(zigzags, tmp_path):
    fit, test, _ = zigzags
    assert confirmed(fit, test, [], Looks(1, 400, None)).nulls is None
    assert confirmed(fit, test, [close(fit, test, CLOSE * 1.01)], Looks(1, 400, None)).nulls is None
    assert confirmed(fit, test, [close(fit, test, 1.2)], Looks(1, 0, None)).nulls is None
    near = confirmed(fit, test, [close(fit, test, 2.6)], Looks(1, 20, tmp_path))
    assert near.nulls is not None and near.nulls.kept.size == 20 and near.nulls.cached == 0
    said = near.record()
    assert said["simulated"]["logs"] == 20 and 0 <= said["achieved"] <= 1 and said["family_wise"] == 0.005
    # The second time nothing is simulated.
    told = []
    again = confirmed(fit, test, [close(fit, test, 2.6)], Looks(1, 20, tmp_path, told.append))
    assert again.nulls.cached == 20 and not told
    np.testing.assert_array_equal(again.nulls.strengths, near.nulls.strengths)


# Nightly: a whole calibration; smaller ones stand in the gate.
@pytest.mark.nightly
def test_null_logs_beside_a_cause_beyond_doubt_follow_the_model_with_it(zigzags, tmp_path):
    fit, test, _ = zigzags
    tide = Given(EFFECTS["current.oscillating"], (0.1, 0.0, 100.0, 0.0))
    late = Given(EFFECTS["thruster.delay"], (0.1,))
    last = replace(fit, states=fit.states.under(replace(fit.h, given=(tide, late))))
    # A delay is not followed, and what is close is not there.
    assert [g.effect.id for g in sound(last, fit, ()).h.given] == ["current.oscillating"]
    assert sound(last, fit, ["current.oscillating"]).h == fit.h
    near = close(fit, test, 2.6)
    beyond = replace(close(fit, test, CLOSE * 1.01), id="current.oscillating")
    plain = confirmed(fit, test, [near], Looks(1, 20, tmp_path), last)
    assert plain.nulls.cached == 0
    assert confirmed(fit, test, [near, beyond], Looks(1, 20, tmp_path)).nulls.cached == 20
    beside = confirmed(fit, test, [near, beyond], Looks(1, 20, tmp_path), last)
    assert beside.nulls.cached == 0 and beside.nulls.kept.size == 20
    assert (beside.nulls.strengths != plain.nulls.strengths).any()


def test_null_logs_of_a_vehicle_without_thrusters_follow_its_known_forces():
    """Forces that a towing tank measures take the place of thrusts."""
    vehicle, log = drawn(duration=90.0)
    curves = [ThrustCurve(t) for t in vehicle.thrusters]
    port, starboard = (c.value(log.columns[f"demand_{t.name}"]) for c, t in zip(curves, vehicle.thrusters, strict=True))
    text = vehicle.text[: vehicle.text.index("[[thrusters]]")] + vehicle.text[vehicle.text.index("[sensors]") :]
    towed = parse_vehicle(text, "towed.toml")
    pushed = {"force_X": port + starboard, "force_Y": 0.0 * port, "moment_N": 0.28 * (port - starboard)}
    columns = {k: x for k, x in log.columns.items() if not k.startswith("demand")} | pushed
    fit = plain_fit(towed, channels(Log("a.csv", "0" * 64, log.t, columns), towed), everything)
    programme = trial_of(fit, frozenset(), StructureTest()).programme
    (made,) = null_logs(programme, 1, [0])
    assert made is not None
    one, true = made
    assert true.given == fit.h.given
    # Each of the three stands beside three parts of its error.
    np.testing.assert_allclose(one.demands[0], programme.log.demands[0], atol=0.5)
    assert one.demands.shape == (9, one.n) and np.ptp(one.demands[0]) > 10
    # The motion is the log's own but for its noise and its ambient force.
    assert np.corrcoef(one.nu[0], programme.log.nu[0])[0, 1] > 0.95
