"""Losses on the other log: their rate where there is none, and their power."""

import numpy as np
import pytest
from scipy.stats import binom, wilcoxon

from ivsid.diagnosis.statements.losses import losses, signed_ranks

NAMES = ("u", "v", "r", "position", "X", "Y", "N")
WINDOWS = {"u": 30, "v": 30, "r": 30, "position": 10, "X": 30, "Y": 30, "N": 30}


def drawn(rng, ratio=1.0, lost=(), spread=0.3):
    """Errors before and after in windows: heavy tails, common to both and across quantities; some grow by a ratio."""
    common = rng.standard_t(4, size=30)
    made = {}
    for name, count in WINDOWS.items():
        before = np.exp(0.5 * common[:count] + rng.standard_t(4, size=count))
        after = before * np.exp(spread * (common[:count] + rng.standard_t(4, size=count)))
        made[name] = (before, after * (ratio if name in lost else 1.0))
    return made


def test_a_model_that_is_no_worse_is_called_worse_in_a_hundredth_of_all_logs():
    rng = np.random.default_rng(5)
    called = sum(bool(losses(drawn(rng))) for _ in range(1500))
    # Holm's procedure keeps 1 % over all seven; a level of 10 % would call more than 45.
    assert called <= binom.ppf(0.999, 1500, 0.01)


def test_a_loss_in_every_window_is_told():
    rng = np.random.default_rng(6)
    found = losses(drawn(rng, ratio=1.3, lost=("X",), spread=0.05))
    assert list(found) == ["X"] and 0 < found["X"] < 0.01 / 7
    # Ten windows can tell it by themselves.
    assert list(losses(drawn(rng, ratio=2.0, lost=("position",), spread=0.05))) == ["position"]


@pytest.mark.parametrize("after", [lambda x: x, lambda x: 0.5 * x, lambda x: np.where(np.arange(30) == 3, 1e3, x)])
def test_what_is_equal_better_or_worse_in_one_window_is_no_loss(after):
    before = np.exp(np.random.default_rng(7).normal(size=30))
    assert losses({"u": (before, after(before))}) == {}


def test_a_log_without_windows_tells_nothing():
    assert losses({"u": (np.zeros(0), np.zeros(0)), "X": (np.ones(2), np.full(2, 9.0))}) == {}


@pytest.mark.parametrize("count", [1, 2, 7, 50, 51, 300])
@pytest.mark.parametrize("step", [None, 0.1])
def test_ranks_are_those_of_scipy_with_and_without_ties(count, step):
    rng = np.random.default_rng(count)
    for shift in (-0.5, 0.0, 0.4):
        x = rng.standard_normal(count) + shift
        x = x if step is None else step * (np.round(np.abs(x) / step) + 1) * np.sign(x)
        exact = count <= 50 and np.unique(np.abs(x)).size == count
        scipy = wilcoxon(x, alternative="greater", method="exact" if exact else "approx", correction=not exact)
        assert signed_ranks(x) == pytest.approx(scipy.pvalue, rel=1e-9)
