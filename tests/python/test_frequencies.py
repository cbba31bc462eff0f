"""Strength of the noise at a direction's frequencies: the mean fall of chi-squared in noise of any spectrum, and no more for a cause that is there."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from scipy.special import chdtrc
from scipy.stats import t as student
from tests.exam.cases import case

from diagnosis_logs import STRAIGHT, screened, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null import family_wise, frequencies
from ivsid.diagnosis.null.frequencies import Frequencies, Scatter, as_rare, excess, spectrum
from ivsid.diagnosis.null.leaving import Others
from ivsid.diagnosis.null.screening import ANY_CURVE, CLOSER_CURVE, DECLARED_SEA, FREQUENCIES, MINUTES, OWN_PAST
from ivsid.diagnosis.selection import adequacy
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

DRAWS = 40
# Numerators and denominators of recursions: white, long gusts, and a band about a sixth of the highest frequency.
NOISES = {
    "white": ([1.0], [1.0]),
    "gusts": ([1.0], [1.0, -0.9]),
    "band": ([1.0, 0.0, -1.0], [1.0, -1.56, 0.81]),
}


@pytest.fixture(scope="module")
def logged():
    vehicle = vehicle_of()
    return screened(vehicle, train_of(vehicle))


def with_errors(fit, rows, seed):
    """The fit to whitened errors that are drawn, shape (rows, n), and to declared errors that are drawn from their priors."""
    g = fit.gram
    y = rows.reshape(len(rows), len(g.y), g.length).transpose(1, 0, 2).reshape(g.y.shape)
    declared = [k for k in fit.base if g.prior[k] > 0]
    sizes = np.random.default_rng([seed, 1]).standard_normal(len(declared)) / np.sqrt(g.prior[declared])
    y = y + np.tensordot(sizes, g.columns(declared), 1)
    score = np.concatenate([np.einsum("cbi,bi->bc", part, y) for part in g.parts], axis=1)
    # The hypothesis holds none of them.
    made = replace(g, y=y, score=score, energy=(y**2).sum(axis=1), centre=np.zeros_like(g.centre))
    return replace(fit, gram=made)


def noises(fit, kind, seed):
    """Whitened errors of variance 1 with a spectrum, shape (rows, n)."""
    rng, (top, below) = np.random.default_rng(seed), NOISES[kind]
    rows = len(fit.noise.predictor.labels)
    drawn = lfilter(top, below, rng.standard_normal((rows, fit.gram.y.size // rows + 200)), axis=1)[:, 200:]
    return drawn / np.sqrt(np.mean(lfilter(top, below, np.random.default_rng(1).standard_normal(200000)) ** 2))


def linear(logged):
    """Scores with one column over the whole log, of as many kinds as there are."""
    return [s for s in logged.scores if len(s.columns) == 1 and not s.candidate.starts]


def exact(fit, s, kind):
    """Mean fall of one column in noise of a spectrum: the recursion runs backwards over its direction, without any frequency."""
    g, base = fit.gram.only(fit.base), range(len(fit.base))
    g = g.joined(["it"], fit.gram.columns(s.columns), fit.gram.unit[list(s.columns)])
    information = Projection(g, base).information([len(base)])[0, 0]
    own = (g.columns([len(base)]) - g.explained(base, g.regression([len(base)], base)))[0]
    rows, (top, below) = len(fit.noise.predictor.labels), NOISES[kind]
    by_row = own.reshape(-1, rows, g.length).transpose(1, 0, 2).reshape(rows, -1)
    size = np.mean(lfilter(top, below, np.random.default_rng(1).standard_normal(200000)) ** 2)
    before = np.pad(by_row, ((0, 0), (200, 0)))[:, ::-1]
    variance = np.sum(lfilter(top, below, before, axis=1) ** 2) / size
    # Declared errors scatter the score by what white noise of this length does not.
    return (variance + information - np.sum(own * own)) / information


# Nightly: the wide spectra, whose strengths are nearest to one.
@pytest.mark.parametrize("kind", [pytest.param(k, marks=[pytest.mark.nightly] * (k != "band")) for k in NOISES])
def test_the_strength_is_the_mean_fall_in_noise_of_any_spectrum(logged, kind):
    """The oracle is exact and knows of no frequencies; the mean over draws shows that it is the fall's."""
    falls, said = [], []
    some = linear(logged)[::4]
    for seed in range(5 * DRAWS):
        fit = with_errors(logged.fit, noises(logged.fit, kind, seed), seed)
        falls.append([fit.projection.solve(s.columns)[1] for s in some])
        if seed < 5:
            said.append([Frequencies(fit).strength(s).value for s in some])
    mean, said = np.mean(falls, axis=0), np.mean(said, axis=0)
    true = np.array([exact(logged.fit, s, kind) for s in some])
    assert np.all(np.abs(mean - true) < 4.0 * np.sqrt(2 / len(falls)) * true)
    # No strength is below 1.
    assert np.all(said > 0.75 * true)
    assert np.all(said < 1.25 * np.maximum(true, 1.0))
    # Regressors have little at the frequencies of the band.
    assert (said.max() > 5.0) == (kind == "gusts")


# Nightly: white noise, whose falls the gate draws in other tests, and gusts, whose frequencies are more than the band's.
@pytest.mark.parametrize("kind", [pytest.param(k, marks=[pytest.mark.nightly] * (k != "band")) for k in NOISES])
def test_few_frequencies_make_no_rare_falls_common(logged, kind):
    """Falls over their strengths are as rare as they say in draws, whatever the spectrum and however few frequencies make it."""
    some, chances, without = linear(logged)[::4], [], []
    for seed in range(DRAWS):
        fit = with_errors(logged.fit, noises(logged.fit, kind, seed), seed)
        for s in some:
            fall, found = fit.projection.solve(s.columns)[1], Frequencies(fit).strength(s)
            assert found.beside(fall, 1) <= fall / found.value
            chances.append(chdtrc(1, found.beside(fall, 1)))
            without.append(chdtrc(1, fall))
    chances, without = np.array(chances), np.array(without)
    for level in (0.1, 0.01):
        spread = 3.5 * np.sqrt(level / chances.size * len(some) / 3)
        assert np.mean(chances < level) < level + spread
    assert (np.mean(without < 0.01) > 0.05) == (kind == "gusts")


def test_a_known_strength_makes_a_fall_neither_rarer_nor_more_common():
    """Oracle: Student's t of SciPy, whose square is the ratio for one number."""
    falls = np.array([0.5, 9.0, 40.0])
    assert np.array_equal(as_rare(falls, 1, np.full(3, np.inf)), falls)
    for freedom in (3.0, 14.0, 1000.0):
        found = as_rare(falls, 1, np.full(3, freedom))
        assert chdtrc(1, found) == pytest.approx(2 * student.sf(np.sqrt(falls), freedom), rel=1e-9)
        assert np.all(found <= falls)


def test_axes_that_are_left_out_make_no_noise_of_the_others():
    """Yaw is zero where a vehicle hardly turns: samples of all rows for those of some would make the noise of these larger."""
    vehicle = vehicle_of()
    log = channels(train_of(vehicle, segments=STRAIGHT, duration=120.0), vehicle)
    fit = plain_fit(vehicle, log, everything)
    assert fit.noise.left_out
    drawn, ahead = noises(fit, "white", 5), [k == 0 for k, _ in fit.noise.predictor.labels]
    silent = [k in fit.noise.left_out for k, _ in fit.noise.predictor.labels]
    drawn[silent] = 0.0
    fit = with_errors(fit, drawn, 5)
    found = spectrum(fit, fit.gram.only(fit.base)).above
    assert np.all(found[silent] == 1.0)
    # The mean of what is 1 or more, by a periodogram of which thirteen values are summed.
    assert 1.0 < found[ahead].mean() < 1.2


def test_a_cause_that_is_there_is_not_weakened(logged):
    fit = logged.fit
    for s in linear(logged)[::5]:
        (k,) = s.columns
        rows = len(fit.noise.predictor.labels)
        own = fit.gram.columns([k])[0].reshape(-1, rows, fit.gram.length).transpose(1, 0, 2).reshape(rows, -1)
        there = with_errors(fit, noises(fit, "white", 3) + 100.0 * own, 3)
        assert Frequencies(there).strength(s).value < 1.5


def test_the_spectrum_adds_nothing_in_white_noise_and_the_scatter_of_scores_in_any_other(logged):
    """Covariance of scores of regressors: that of draws, and no less than that of white noise."""
    at = sorted({k for s in linear(logged)[::4] for k in s.columns})
    for kind in ("white", "gusts"):
        drawn = []
        for seed in range(DRAWS):
            fit = with_errors(logged.fit, noises(logged.fit, kind, seed), seed)
            drawn.append(fit.projection.left_score[at])
        p = fit.projection
        more = excess(fit, p, at, spectrum(fit, fit.gram.only([*p.base, *at]))).more
        own = np.diag(p.information(at))
        ratio = (np.diag(more) + own) / own
        found = np.var(drawn, axis=0) / own
        assert np.all(np.linalg.eigvalsh(more) > -1e-9 * np.trace(own * np.eye(len(at))))
        assert np.median(ratio / found) < 1.6
        assert np.median(ratio / found) > (0.8 if kind == "gusts" else 0.9)


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("seed", "sea", "hidden"),
    [(508, "band", "wave.force"), (502, "slow", "structure"), (183040, "slow", "current.steady")],
)
def test_an_ambient_force_of_another_spectrum_is_no_finding(seed, sea, hidden, monkeypatch):
    """The examiner's sea has the declared size; without the spectrum of the log it is a wave, or structure that nothing explains."""
    c = case(seed, what="none", sea=sea, sensors="white")
    vehicle = parse_vehicle(c.text, "v.toml")
    train = Log("1.csv", "0" * 64, c.logs[0]["t"], {k: x for k, x in c.logs[0].items() if k != "t"})
    found = screened(vehicle, train)
    assert found.passed == [] and found.quiet
    if hidden == "wave.force":
        # A swell below the declared force is refused for that as well, and past errors foretell it, beside thrust errors too.
        others = FREQUENCIES, DECLARED_SEA, OWN_PAST, ANY_CURVE, CLOSER_CURVE
        kept = tuple(r for r in family_wise.SCREENING if r not in others)
        monkeypatch.setattr(family_wise, "SCREENING", kept)
        assert screened(vehicle, train).passed == [hidden]
    elif hidden == "current.steady":
        # A few frequencies made the estimate of the noise. A slow force inside the declared one refuses the current as well, beside thrust errors too.
        monkeypatch.setattr(frequencies, "as_rare", lambda fall, count, freedom: fall)
        others = MINUTES, ANY_CURVE, CLOSER_CURVE
        monkeypatch.setattr(family_wise, "SCREENING", tuple(r for r in family_wise.SCREENING if r not in others))
        # A drag that grows shows 25 beside a z of less than 8, and passes with it.
        assert set(screened(vehicle, train).passed) - {"fouling.drift"} == {hidden}
    else:
        none = Scatter(np.zeros(1), np.array(np.inf))
        monkeypatch.setattr(adequacy, "excess", lambda fit, p, at, noise: none)
        # Past errors and slow forces explain it as well.
        monkeypatch.setattr(Others, "beside", lambda self: iter(()))
        assert not adequacy.adequacy(found.fit).quiet
