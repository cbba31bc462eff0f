"""The second opinion: half-minutes of one mind about a cause that the base nearly explains, and of none without a cause."""

from types import SimpleNamespace

import numpy as np
import pytest

from ivsid.diagnosis.estimation.cross_products import Gram
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.null.second_opinion import second_opinion

BLOCKS, ROWS, BASE = 30, 200, (0, 1, 2)


def columns(rng):
    """Three of a base whose strengths wander from block to block, and one that they nearly explain, shape (blocks, rows, 4)."""
    x = rng.standard_normal((BLOCKS, ROWS, 4)) * rng.uniform(0.2, 2.0, (BLOCKS, 1, 4))
    x[..., 3] = x[..., :3] @ [1.0, -0.7, 0.5] + 0.05 * rng.standard_normal((BLOCKS, ROWS))
    return x


def opinion(x, y, start=0):
    """The second opinion on the last column, which acts from a block on, as of a log."""
    unit = np.sqrt((x**2).sum(axis=(0, 1)))
    c = (x / unit).transpose(0, 2, 1)
    blocks, none = c @ c.transpose(0, 2, 1), np.zeros(4)
    y_blocks, good = (y**2).sum(axis=1), np.ones(y.size, dtype=bool)
    g = Gram(
        tuple("abcd"),
        (),
        y,
        blocks,
        np.einsum("bki,bi->bk", c, y),
        y_blocks,
        np.full(BLOCKS, float(ROWS)),
        none,
        none,
        unit,
        good,
        ROWS,
        None,
    )
    fit = SimpleNamespace(
        projection=Projection(g, BASE),
        gram=g,
        noise=SimpleNamespace(predictor=SimpleNamespace(log=None)),
    )
    return second_opinion(fit, SimpleNamespace(columns=(3,), first_block=lambda *_: start))


@pytest.mark.parametrize("start", [0, 12])
def test_half_minutes_agree_on_a_cause_that_the_base_nearly_explains(start):
    """Its score in a half-minute is that of its own part beside the base, which is not its part times the whole column."""
    said = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        x = columns(rng)
        acting = x[..., 3] * (np.arange(BLOCKS) >= start)[:, None]
        rest = (
            acting.ravel()
            - x[..., :3].reshape(-1, 3) @ np.linalg.lstsq(x[..., :3].reshape(-1, 3), acting.ravel(), rcond=None)[0]
        )
        # Seven standard deviations of white noise.
        y = acting * 7.0 / np.linalg.norm(rest) + rng.standard_normal((BLOCKS, ROWS))
        said.append(opinion(x, y, start))
    assert np.mean(np.array(said) < 5e-3) >= 0.9


@pytest.mark.parametrize("start", [0, 12])
def test_without_a_cause_the_opinion_is_a_probability(start):
    said = []
    for seed in range(300):
        rng = np.random.default_rng([seed, 1])
        said.append(opinion(columns(rng), rng.standard_normal((BLOCKS, ROWS)), start))
    # A hundredth of 300 is three, a tenth is thirty: half-minutes of unlike strength make Fisher's F an approximation.
    assert np.mean(np.array(said) < 0.01) <= 0.03 and 0.05 < np.mean(np.array(said) < 0.1) < 0.17


def test_one_column_is_solved_to_the_bit_as_several_are():
    """Most causes have one number, and need no eigenvalues."""
    rng = np.random.default_rng(8)
    x = rng.standard_normal((9, 40, 50))
    x[8] = x[0] + x[1]
    y, none = rng.standard_normal((40, 50)), np.zeros(9)
    good = np.ones(y.size, dtype=bool)
    blocks, score = np.einsum("cbi,dbi->bcd", x, x), np.einsum("cbi,bi->bc", x, y)
    energy, rows = (y**2).sum(axis=1), np.full(40, 50.0)
    g = Gram(tuple("abcdefghi"), (), y, blocks, score, energy, rows, none, none, np.ones(9), good, 50, None)
    p = Projection(g, range(4))
    for k in range(4, 8):
        H, s = p.information([k]), p.left_score[[k]]
        d = np.sqrt(np.diag(H))
        values, vectors = np.linalg.eigh(H / np.outer(d, d))
        theta = (vectors / values) @ (vectors.T @ (s / d)) / d
        found, fall = p.solve([k])
        assert found.tolist() == theta.tolist() and fall == float(s @ theta)
    # A column that the base explains has nothing left.
    assert p.solve([8])[0].tolist() == [0.0] and p.solve([8])[1] == 0.0
