"""Allan deviation: the published reference set, known noise, refusals."""

import allantools
import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.allan import allan_deviation
from ivsid.simulation import gauss_markov


def test_the_reference_set_of_nist_sp_1065():
    n = [1234567890]
    for _ in range(999):
        n.append(16807 * n[-1] % 2147483647)
    y = np.array(n) / 2147483647
    taus, deviation, _, _ = allantools.oadev(y, rate=1.0, data_type="freq", taus=[1, 10, 100])
    assert taus.tolist() == [1, 10, 100]
    assert deviation == pytest.approx([2.922319e-1, 9.159953e-2, 3.241343e-2], rel=1e-6)
    curve = allan_deviation("reference", y, 1.0)
    at = {round(t): d for t, d in zip(curve.taus, curve.deviation, strict=True)}
    assert at[1] == pytest.approx(2.922319e-1, rel=1e-6)


def test_random_walk_and_bias_are_read_off():
    rng = np.random.default_rng(3)
    h, n_true, b_true, t_true = 0.05, 1.8e-3, 3.0e-3, 20.0
    samples = 160_000
    values = rng.standard_normal(samples) * n_true / np.sqrt(h) + gauss_markov(samples, h, b_true, t_true, rng)
    curve = allan_deviation("ax", values, h)
    assert curve.random_walk == pytest.approx(n_true, rel=0.05)
    assert curve.bias_instability == pytest.approx(b_true, rel=0.15)
    assert curve.bias_time == pytest.approx(t_true, rel=0.35)
    assert curve.resolved
    peak = curve.taus[np.argmax(curve.model(curve.taus) - n_true / np.sqrt(curve.taus))]
    assert peak == pytest.approx(1.89 * curve.bias_time, rel=0.5)


def test_white_noise_has_no_resolved_bias():
    values = np.random.default_rng(4).standard_normal(20_000)
    curve = allan_deviation("r", values, 0.1)
    assert curve.random_walk == pytest.approx(np.sqrt(0.1), rel=0.05)
    assert not curve.resolved


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        (np.zeros(50), "at least 100"),
        (np.ones(500), "constant at 1"),
        (np.r_[np.nan, np.random.default_rng(0).standard_normal(500)], "misses samples"),
    ],
)
def test_refusals(values, sentence):
    with pytest.raises(IvsidError, match=sentence):
        allan_deviation("x", values, 0.1)
