"""The region of anchors that a log allows: a bent strip, whose slopes at the best place show its width alone."""

from types import SimpleNamespace

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid.diagnosis.candidates import intervals
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.candidates.intervals import Bound
from ivsid.diagnosis.candidates.profile import region
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.fit import survey
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.effects import EFFECTS, Given
from ivsid.vehicle import parse_vehicle


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


@pytest.mark.parametrize(("end", "open_"), [(900.0, False), (4e10, True)])
def test_an_anchor_far_beyond_the_track_has_no_bound(monkeypatch, end, open_):
    """A pull from there has a direction and no place: a coordinate of 4e10 m says nothing."""
    monkeypatch.setattr(intervals, "profile", lambda *_: None)
    monkeypatch.setattr(intervals, "rise", lambda *_: 1.0)
    monkeypatch.setattr(intervals, "region", lambda *_: ((-5.0, end), (2.0, 3.0)))
    track = np.array([[0.0, 10.0], [0.0, 4.0]])
    fit = SimpleNamespace(problem=None, states=SimpleNamespace(points=SimpleNamespace(place=track)))
    given = Given(EFFECTS["tether.tension"], (10.0, 1.0, 2.5, 0.0))
    out = {f"tether.tension.anchor_{k}": Bound(1.0, 2.0, "m", "") for k in ("north", "east")}
    intervals._places(fit, given, 1.0, out, {})
    north, east = out.values()
    assert (north.lower, north.upper) == (-5.0, np.inf if open_ else end)
    assert (east.lower, east.upper) == (1.0, 3.0)


def test_the_arm_of_a_pull_is_open_where_yaw_is_left_out():
    """No row tells of it: its interval had ends of 1e155 m."""
    c = case(254090, what="none", style="line", kind="rov", duration=120.0, sea="any", sensors="any")
    vehicle = parse_vehicle(c.text, "v.toml")
    fit = plain_fit(vehicle, channels(logs_of_case(c)[0], vehicle), everything)
    assert fit.noise.left_out == {2}
    h = fit.h.with_effect(Given(EFFECTS["tether.tension"], (1.0, 200.0, 30.0, 0.0)))
    pulled = survey(fit.noise, fit.states.under(h), fit.fixed)
    found = {n.removeprefix("tether.tension."): b for n, b in intervals.intervals(pulled, "tether.tension").items()}
    assert (found["arm"].lower, found["arm"].upper) == (-np.inf, np.inf)
    assert np.isfinite(found["force"].upper) and found["force"].upper < 1e6
