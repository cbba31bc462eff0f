"""Stop operators against the rule that defines them, one demand after the other, and as errors of a thrust."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ivsid.diagnosis.plant.hysteresis import stop


def pushed(demand, width):
    """A pointer in a slot that moves with the demand: its ends push it."""
    pointer, found = demand[0], []
    for d in demand:
        if pointer > d + width / 2:
            pointer = d + width / 2
        if pointer < d - width / 2:
            pointer = d - width / 2
        found.append((d - pointer) / (width / 2))
    return np.array(found)


@given(st.integers(0, 10**6), st.integers(1, 400), st.floats(0.01, 50.0))
@settings(max_examples=100, deadline=None)
def test_a_stop_is_what_a_pointer_in_a_slot_is_behind(seed, count, width):
    demand = np.cumsum(np.random.default_rng(seed).standard_normal(count))
    found = stop(demand, width)
    np.testing.assert_allclose(found, pushed(demand, width), atol=1e-9)
    assert np.abs(found).max() <= 1 + 1e-12


def test_a_stop_remembers_the_last_turn_and_not_the_way_to_it():
    up, down = np.linspace(0.0, 100.0, 501), np.linspace(100.0, 40.0, 301)
    one = stop(np.concatenate([up, down]), 10.0)
    other = stop(np.concatenate([up[::50], [100.0], down]), 10.0)
    assert one[500] == 1.0 and one[-1] == -1.0
    np.testing.assert_allclose(one[-301:], other[-301:], atol=1e-12)
    # Its demand keeps moving by less than half the slot: the error stays between its ends.
    kept = stop(np.r_[up, 100.0 - 2.0 * (np.arange(200) % 2)], 10.0)
    assert kept[-200:] == pytest.approx(np.where(np.arange(200) % 2, 0.6, 1.0))
