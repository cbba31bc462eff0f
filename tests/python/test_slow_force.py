"""Ambient forces that change over minutes, inside the declared one and beyond it."""

import re

import numpy as np
import pytest
from scipy.optimize import minimize
from tests.exam.cases import case
from tests.exam.seas import PERIODS

from diagnosis_logs import logs_of, logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null import leaving
from ivsid.diagnosis.null import round as screening_round
from ivsid.diagnosis.null.own_past import OwnPast
from ivsid.diagnosis.null.slow_force import HALF_WAVES, HARMONICS, SlowForce, wave_beside
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.statements import shallow_water
from ivsid.vehicle import parse_vehicle

SHORT = {"what": "none", "duration": 300.0, "rate": 10.0, "sensors": "white"}
# Sound logs whose sea looked like a force outside the catalogue: seeds of the examiner, found among eighty.
# Nightly: a force of both signs; one of one sign is the harder, since its mean is a force that stands still.
CASES = [pytest.param(60, "minutes", marks=pytest.mark.nightly), (8, "one-sided")]
# Sound logs in ten times the usual sea that had a cause by name.
NAMED = [
    # Nightly: the gate asks rules of causes beside slow forces by a wind, a part of which is inside the declared force.
    pytest.param(176, "minutes", "rich", screening_round, "fouling.drift", marks=pytest.mark.nightly),
    pytest.param(106, "minutes", "circle", shallow_water, "environment.shallow_water", marks=pytest.mark.nightly),
]


def fitted(vehicle, train):
    return plain_fit(vehicle, channels(train, vehicle), everything)


def drawn(seed, sea, *, declared=1.0, **asked):
    """A sound log in a sea of the examiner's, whose vehicle file declares another multiple of its force, and both logs."""
    c = case(seed, sea=sea, **SHORT, **asked)
    text = re.sub(r"(?<=\[ambient\]\nforce = )\S+", lambda x: f"{float(x[0]) * declared:.6g}", c.text)
    text = re.sub(r"(?<=\nmoment = )\S+(?=\ntime)", lambda x: f"{float(x[0]) * declared:.6g}", text)
    return parse_vehicle(text, "v.toml"), *logs_of_case(c)


@pytest.mark.parametrize("period", [None, 7.3])
def test_falls_beside_slow_forces_are_those_of_a_fit_with_them(period):
    """The oracle: least squares on the base, the cause and the slow forces at once, each with its prior as a row of its own."""
    vehicle = vehicle_of()
    fit, scored = score(fitted(vehicle, train_of(vehicle)))
    slow, g = SlowForce(fit, period), fit.gram
    columns = g.columns(list(fit.base)).reshape(len(fit.base), -1)
    prior = g.prior[list(fit.base)]
    known = (g.prior * g.centre)[list(fit.base)]
    forces, _ = slow._shapes
    assert len(forces) == 5 * (HALF_WAVES + 1 + (0 if period is None else 2 * HARMONICS))

    def least(more):
        every = np.concatenate([columns, forces, more])
        root = np.sqrt(np.r_[prior, np.zeros(len(forces) + len(more))])
        rows = np.diag(root)
        own = slice(len(columns), len(columns) + len(forces))
        rows[own, own] = np.linalg.cholesky(slow.prior).T
        # A prior is a row that asks for its centre.
        A = np.concatenate([every.T, rows])
        b = np.r_[g.y.ravel(), np.zeros(len(every))]
        at = root[: len(fit.base)] > 0
        b[g.y.size : g.y.size + len(fit.base)][at] = -(known[at] / root[: len(fit.base)][at])
        solved = np.linalg.lstsq(A, b, rcond=None)
        return float(solved[1][0]), solved[0][len(columns) + len(forces) :]

    nothing, _ = least(np.zeros((0, columns.shape[1])))
    some = [s for s in scored if s.candidate.sums and not s.candidate.starts][::8]
    assert len(some) > 3
    for s in some:
        own = g.columns(s.columns).reshape(len(s.columns), -1)
        left, beside = least(own)
        assert slow.fall(s) == pytest.approx(nothing - left, rel=1e-4, abs=1e-3), s.id
        alone = Projection(g, [*fit.base, *s.columns]).coefficients[len(fit.base) :]
        assert slow.moved(s) == pytest.approx(beside - alone, rel=1e-3, abs=1e-3), s.id


# Nightly: a square wave beside other forces; the gate has one by itself.
@pytest.mark.parametrize(("seed", "alone"), [pytest.param(250004, False, marks=pytest.mark.nightly), (250005, True)])
def test_the_wave_of_a_square_wave_is_the_one_that_a_log_shows(seed, alone):
    vehicle, train, _ = drawn(seed, "square")
    beside = wave_beside(fitted(vehicle, train))
    # Each axis has a square wave of its own period, which the examiner draws before its phase.
    rng = np.random.default_rng([seed, 0, 0])
    periods = [(vehicle.ambient.time * rng.uniform(*PERIODS), rng.uniform())[0] for _ in range(2)]
    assert beside is not None and min(abs(beside._period / p - 1.0) for p in periods) < 2e-3
    # Without it the errors of four turning thrusters show a wave of their own in the other log.
    vehicle, train, _ = drawn(seed, "markov")
    assert (wave_beside(fitted(vehicle, train)) is None) == alone


@pytest.mark.parametrize("newton", [0.0, 0.4])
def test_slow_forces_keep_their_bound_and_explain_what_they_can(newton):
    """The oracle: sequential least squares with the bounds as constraints, from no force on."""
    vehicle = vehicle_of()
    fit = fitted(vehicle, train_of(vehicle, {"wind.steady.north": newton, "wind.steady.east": -0.7 * newton}))
    slow, g = SlowForce(fit), fit.gram
    forces, products = slow._shapes
    base = list(fit.base)
    every = np.concatenate([g.columns(base).reshape(len(base), -1), forces])
    prior = np.r_[g.prior[base], np.ones(len(forces))]
    N = every @ every.T + np.diag(prior)
    score = every @ g.y.ravel() - np.r_[(g.prior * g.centre)[base], np.zeros(len(forces))]
    # The base is free, so that it is solved for beside any sizes.
    b = slice(0, len(base))
    f = slice(len(base), None)
    held = np.linalg.solve(N[b, b], N[b, f])
    A, s = N[f, f] - N[f, b] @ held, score[f] - held.T @ score[b]
    most = minimize(
        lambda c: c @ A @ c - 2 * s @ c,
        np.zeros(len(s)),
        jac=lambda c: 2 * (A @ c - s),
        method="SLSQP",
        constraints=[
            {"type": "ineq", "fun": lambda c, P=P: 1 - c @ P @ c, "jac": lambda c, P=P: -2 * P @ c} for P in products
        ],
        options={"maxiter": 500, "ftol": 1e-10},
    )
    assert most.success
    own = np.linalg.solve(A - np.eye(len(s)) + slow.prior, s)
    rms = np.sqrt(own @ products @ own)
    assert np.all(rms < 1.006) and (rms.max() > 0.99) == (newton > 0.0)
    assert own @ A @ own - 2 * s @ own == pytest.approx(most.fun, abs=0.1)


@pytest.mark.parametrize(("seed", "sea"), CASES)
def test_a_force_of_minutes_inside_the_declared_one_is_none_that_the_catalogue_lacks(seed, sea, monkeypatch):
    vehicle, train, _ = drawn(seed, sea)
    fit = fitted(vehicle, train)
    found = adequacy(fit)
    # Its numbers may be those of the force as well.
    assert found.quiet and found.leans and not found.certain
    slow = SlowForce(fit)
    assert not slow.beyond and slow.spectrum(fit.gram.only(fit.base)) is not None
    monkeypatch.setattr(leaving, "slow_force", lambda _: None)
    # The spectrum of the noise and long pasts explain the thrust errors that one of these forces asks for as well.
    monkeypatch.setattr(leaving, "spectrum", lambda *_: None)
    monkeypatch.setattr(leaving, "LongPast", OwnPast)
    assert not adequacy(fit).quiet


@pytest.mark.parametrize(("seed", "sea"), CASES)
def test_a_force_of_minutes_beyond_the_declared_one_is_told(seed, sea):
    """The same log beside a vehicle file that declares a fifth of the force."""
    vehicle, train, _ = drawn(seed, sea, declared=0.2)
    fit = fitted(vehicle, train)
    slow = SlowForce(fit)
    assert not adequacy(fit).quiet and slow.beyond
    # What is left beside forces that stay inside the bound is none of the noise.
    assert slow.spectrum(fit.gram.only(fit.base)) is None


def test_noise_faster_than_slow_forces_scatters_what_is_left_beside_them(monkeypatch):
    """One wave a log and others of twenty seconds, each with the declared rms: what is left beside slow forces is as strong as the noise at its frequencies."""
    c = case(244099, what="none", sea="minutes", sensors="white")
    fit = fitted(parse_vehicle(c.text, "v.toml"), logs_of_case(c)[0])
    assert adequacy(fit).quiet
    monkeypatch.setattr(SlowForce, "spectrum", lambda self, g: None)
    # Long pasts, which are asked last, count the spectrum as well.
    monkeypatch.setattr(leaving, "LongPast", OwnPast)
    assert not adequacy(fit).quiet


@pytest.mark.parametrize(("seed", "sea", "style", "module", "name"), NAMED)
def test_a_force_of_minutes_inside_the_declared_one_has_no_name(seed, sea, style, module, name, monkeypatch):
    vehicle, *both = drawn(seed, sea, style=style, ambient=10.0)
    beside = diagnose(vehicle, *both, null_logs=0)
    assert beside.verdict == "adequate"
    monkeypatch.setattr(module, "slow_force", lambda _: None)
    without = diagnose(vehicle, *both, null_logs=0)
    # Since biases have seven shapes the worst of all errors takes a fouling as well, where a slow force alone is not asked.
    rules = [found.selection.refused[name].rule for found in (beside, without) if name in found.selection.refused]
    assert name in {f.effect for f in without.findings} or rules == ["minutes", "any curve"]


# Nightly: one of four fifths of the declared rms is a part of that; the gate has a sound log whose force lasts as long.
@pytest.mark.parametrize(("newton", "there"), [(0.9, True), pytest.param(0.12, False, marks=pytest.mark.nightly)])
def test_a_wind_beyond_the_declared_force_keeps_its_name(newton, there):
    """One of six times the declared rms stands."""
    vehicle = vehicle_of()
    found = diagnose(vehicle, *logs_of(vehicle, {"wind.steady.north": newton, "wind.steady.east": 0.0}), null_logs=0)
    assert ("wind.steady" in {f.effect for f in found.findings}) == there
    assert found.verdict == ("wrong" if there else "adequate")


def test_a_fall_that_thrust_errors_may_make_is_no_strong_cause(monkeypatch):
    """Beside it slow forces are asked all the same: a sound vessel had a wind and a tether beside a dead band of 2,459 that its thrust errors may make."""
    vehicle, train, _ = drawn(8, "one-sided", thrust="sawtooth", share=1.0)
    fit, found = score(fitted(vehicle, train))
    here = screening_round.Round(fit, tuple(found), 1e-4, {})
    most = max((s for s in found if s.physical), key=lambda s: s.shown)
    left = here.left(most)
    assert left < 0.7 * most.shown
    for limit, strong in ((0.5 * (left + most.shown), False), (0.9 * left, True)):
        monkeypatch.setattr(screening_round, "FORETOLD", limit)
        assert screening_round.Round(fit, tuple(found), 1e-4, {}).strong == strong
