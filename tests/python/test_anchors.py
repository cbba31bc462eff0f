"""The region of anchors that a log allows: a bent strip, whose slopes at the best place show its width alone."""

import numpy as np
import pytest

from ivsid.diagnosis.candidates.profile import region


def strip(north, east):
    """Rise of chi-squared beside a strip that bends away from its best place, at (3, 1)."""
    along, across = north - 3.0, east - 1.0 - 0.05 * (north - 3.0) ** 2
    return (along / 2.0) ** 2 + (across / 0.2) ** 2


@pytest.mark.parametrize("most", [4.0, 10.9])
def test_the_region_holds_every_place_of_a_bent_strip(most):
    (low, high), (least, largest) = region(strip, (3.0, 1.0), (1.5, 0.6), most)
    reach = 2.0 * np.sqrt(most)
    assert low <= 3.0 - reach and high >= 3.0 + reach
    assert largest >= 1.0 + 0.05 * reach**2 and least <= 1.0 - 0.1 * np.sqrt(most)
    # No wider than a few steps of the lattice more.
    assert high - low < 3.5 * reach and largest - least < 6.0 * (0.05 * reach**2 + 0.2)


def test_a_round_region_is_no_wider_than_its_slopes_say():
    (low, high), (least, largest) = region(lambda a, b: a**2 + (b / 2) ** 2, (0.0, 0.0), (3.3, 6.6), 3.3**2)
    assert 3.3 <= high == -low <= 5.0 and 6.6 <= largest == -least <= 10.0


def test_an_anchor_at_any_distance_has_a_wide_region():
    (low, high), _ = region(lambda a, b: 100.0 * b**2, (0.0, 0.0), (1.0, 1.0), 10.0)
    assert high > 50.0 and low < -50.0
