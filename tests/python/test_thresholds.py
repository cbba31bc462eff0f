"""Threshold of the Gaussian draws: a rate, not a draw of luck."""

from dataclasses import replace

import numpy as np
import pytest

from diagnosis_logs import TWIN, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.levels import NAMES
from ivsid.diagnosis.null.thresholds import DRAWS, calibrate
from ivsid.diagnosis.null.visibility import visibility
from sampling import NIGHTLY


@pytest.fixture(scope="module")
def fit():
    vehicle = vehicle_of(TWIN)
    return plain_fit(vehicle, channels(train_of(vehicle), vehicle), everything)


@pytest.fixture(scope="module")
def seen(fit):
    return frozenset(i for i, v in visibility(fit).items() if v.tested)


def test_seeds_agree_on_the_threshold(fit, seen):
    """Before, 400 draws by block moved it by a factor of 1.6 to 2.3 between five seeds.

    Sixty of 12,000 draws lie beyond, so that one threshold has a standard error of 13 % and five differ by 1.35 as a rule: this was met by
    luck. Four times as many draws have half of it, and show that nothing but the number of draws moves the threshold.
    """
    found = [calibrate(fit, seen, NAMES, seed, draws=4 * DRAWS).chance for seed in range(5)]
    assert max(found) < 1.35 * min(found)


def test_the_sign_of_an_eigenvector_changes_nothing(fit, seen, monkeypatch):
    before = calibrate(fit, seen, NAMES, 1, draws=500)
    real = np.linalg.eigh

    def flipped(a):
        values, vectors = real(a)
        return values, vectors * np.where(np.arange(len(values)) % 2, -1.0, 1.0)

    monkeypatch.setattr("numpy.linalg.eigh", flipped)
    after = calibrate(fit, seen, NAMES, 1, draws=500)
    np.testing.assert_allclose(after.smallest, before.smallest, rtol=1e-6)


@pytest.mark.sampled
def test_the_draws_score_as_noise_does(fit, seen):
    """White noise in place of the errors, with the package's scores of it: as many below the threshold of 10 % as a tenth of the logs.

    The draws are not used, but for their threshold: they have to foretell how often whole scores pass.
    """
    rng = np.random.default_rng(4)
    at_ten = calibrate(fit, seen, 0.1, 1, draws=4000)
    tested = tuple(c for c in fit.candidates if c.variants and c.id in seen)

    passed, logs = 0, 400 if NIGHTLY else 60
    g = fit.gram
    known = [k for k in fit.base if g.prior[k] > 0]
    for _ in range(logs):
        y = rng.standard_normal(g.y.shape)
        sizes = rng.standard_normal(len(known)) / np.sqrt(g.prior[known])
        y = y + g.explained(known, sizes)
        scores = np.concatenate([np.einsum("cbi,bi->bc", part, y) for part in g.parts], axis=1)
        noise = replace(g, y=y, score=scores, energy=np.einsum("bi,bi->b", y, y), centre=np.zeros(len(g.names)))
        _, scored = score(replace(fit, gram=noise, candidates=tested))
        passed += min(s.chance if s.physical else 1.0 for s in scored) <= at_ten.chance
    # Three standard deviations of a count on either side; a level of 1 % or of 25 % lies outside.
    assert abs(passed - 0.1 * logs) < 3 * np.sqrt(0.09 * logs), passed
