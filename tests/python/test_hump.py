"""Humps of the wave resistance: their force, the search for speed and width, and what their outline leaves."""

import itertools
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from tests.exam.cases import case

from diagnosis_logs import logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.selection.force_rules import BENT, BETTER_CURVE, OUTLINE, Curve, Remainder
from ivsid.diagnosis.selection.rivals import MARGIN, Found, Rival
from ivsid.diagnosis.selection.rules import compared
from ivsid.diagnosis.selection.select import Selection, in_place
from ivsid.effects import EFFECTS, State
from ivsid.vehicle import parse_vehicle

HUMP = EFFECTS["drag.surge.hump"]


def scored(**numbers):
    """The score of the hump in a log with these of its numbers, or with none."""
    vehicle = vehicle_of()
    truth = {f"{HUMP.id}.{k}": v for k, v in numbers.items()}
    fit = plain_fit(vehicle, channels(train_of(vehicle, truth, duration=150.0), vehicle), everything)
    return {s.id: s for s in score(fit)[1]}[HUMP.id]


def force(u, height, speed, width):
    return HUMP.acts.function(State(u, 0.0, 0.0, 0.0, 0.0, 0.0), (height, speed, width))["surge"]


def test_the_force_is_a_drag_of_its_height_at_its_speed_and_none_at_rest():
    for u in np.linspace(-2.0, 2.0, 41).tolist():
        one, other = (math.cosh((u - s * 0.8) / 0.2) ** -2 for s in (1, -1))
        assert force(u, 5.0, 0.8, 0.2) == pytest.approx(5.0 * (other - one), abs=1e-12)
        assert force(u, 5.0, 0.8, 0.2) * u <= 0.0 and force(-u, 5.0, 0.8, 0.2) == pytest.approx(
            -force(u, 5.0, 0.8, 0.2)
        )
    assert force(0.0, 5.0, 0.8, 0.2) == 0.0 and force(0.8, 5.0, 0.8, 0.2) == pytest.approx(-5.0, rel=1e-2)


def test_a_fit_moves_a_hump_no_farther_than_its_flank_is_sailed():
    form = HUMP.form
    for speed, width in itertools.product((0.1, 0.4, 0.9, 1.3, 2.5), (0.05, 0.3, 0.8, 2.0)):
        height, *inside = form.inside((3.0, speed, width), 1.0)
        assert height == 3.0 and form.shown({"height": 3.0, "speed": inside[0], "width": inside[1]}, 300.0, 1.0)
        shown = form.shown({"height": 3.0, "speed": speed, "width": width}, 300.0, 1.0)
        assert (inside == [speed, width]) is shown


# Nightly: a whole diagnosis with a second search; the gate takes the search and the rules of humps.
@pytest.mark.nightly
def test_a_flank_alone_is_a_cubic_drag_or_a_hump():
    """A hump beyond the largest speed of the log: its height may be none, a cubic drag stands in its place, and the two are not told apart."""
    c = case(211125)
    result = diagnose(parse_vehicle(c.text, "v.toml"), *logs_of_case(c))
    (one,) = result.findings
    assert {one.effect, *one.alternatives} == {"drag.surge.cubic", HUMP.id}
    assert 0.5 < one.confidence < 1.0 and one.separate_by


def test_the_search_finds_speed_and_height_and_a_thrust_of_that_shape_is_no_drag():
    found = scored(height=12.0, speed=0.7, width=0.25)
    height, speed, width = found.values
    assert found.fall > 100.0 and found.physical and found.count == 3
    assert 0.5 < speed < 0.9 and 0.1 < width < 0.6 and 4.0 < height < 36.0
    assert 1.0 <= found.looks <= 36.0
    assert found.chance < 1e-10 < scored().chance


def test_a_hump_that_drives_is_not_possible():
    candidate = scored().candidate
    assert candidate.possible((1.0,)) and not candidate.possible((-1.0,))


def test_a_log_shows_a_hump_with_a_flank_that_it_sails_and_a_period_that_it_holds():
    form = HUMP.form
    for speed, width, shown in ((0.8, 0.3, True), (1.3, 0.35, True), (1.4, 0.3, False), (0.2, 0.3, False)):
        assert form.shown({"height": 1.0, "speed": speed, "width": width}, 300.0, 1.0) is shown
    swell = EFFECTS["wave.force"].form
    for period, shown in ((899.0, True), (901.0, False)):
        assert swell.shown({"period": period}, 300.0, 1.0) is shown


def test_what_the_outline_leaves_is_no_cause_and_more_is_one():
    whole = 5000.0
    little, much = (Remainder(share * BENT * whole, HUMP.id, whole) for share in (0.9, 1.1))
    assert OUTLINE.refuses(much) is None
    said = OUTLINE.refuses(little)
    assert said.rule == "outline" and HUMP.id in said.sentence


def test_a_drag_of_a_known_shape_comes_before_a_hump_that_is_not_told_from_it():
    hump, linear = (Rival(id_, None, 0.0, 1, fall) for id_, fall in ((HUMP.id, 208.0), ("drag.surge.linear", 200.0)))
    assert max(hump, linear, key=lambda r: r.place) is linear
    clear = Rival(HUMP.id, None, 0.0, 1, 200.0 + MARGIN + 1.0)
    assert max(clear, linear, key=lambda r: r.place) is clear


def test_two_causes_that_differ_by_the_errors_of_the_equations_are_rivals():
    """A delay of 12.5 ms was behind a lag of 12 ms by 39.5 of 17,533 in chi-squared, and the lag was named alone; one per cent is no such error."""

    def alone(whole, behind):
        lag, delay = (
            Rival(i, None, 0.0, 1, f) for i, f in (("thruster.lag", whole), ("thruster.delay", whole - behind))
        )
        return [r.id for r in compared(lag, [lag, delay], [])[0]]

    assert alone(17_533.0, 39.5) == ["thruster.lag", "thruster.delay"]
    assert alone(17_533.0, 175.0) == ["thruster.lag"]
    # Three standard deviations tell weak causes apart.
    assert alone(400.0, 8.9) == ["thruster.lag", "thruster.delay"] and alone(400.0, 9.1) == ["thruster.lag"]


def test_a_cause_whose_lead_a_thrust_curve_may_make_is_named_with_its_rival():
    """A hump led a true cubic drag by 80 in chi-squared fitted in full, and by less than its numbers cost beside any thrust curve."""
    best, drag, lag = (
        Rival(i, None, 0.0, 1, f) for i, f in ((HUMP.id, 482.0), ("drag.surge.cubic", 402.0), ("thruster.lag", 300.0))
    )

    def named(falls):
        # Scores of the round beside any curve, by id.
        asked = SimpleNamespace(scored=[SimpleNamespace(id=i) for i in falls], free=lambda s: falls[s.id])
        return [r.id for r in compared(best, [best, drag, lag], [], asked)[0]]

    assert named({HUMP.id: 203.0, "drag.surge.cubic": 205.0}) == [HUMP.id, "drag.surge.cubic"]
    assert named({HUMP.id: 203.0, "drag.surge.cubic": 193.0}) == [HUMP.id]
    assert named({HUMP.id: 203.0}) == [HUMP.id]
    # Lags bend the errors: their scores do not say which is the better one.
    one, other = (Rival(i, None, 0.0, 1, f) for i, f in (("thruster.lag", 482.0), ("thruster.shaft_lag", 402.0)))
    asked = SimpleNamespace(scored=[SimpleNamespace(id=r.id) for r in (one, other)], free=lambda s: 0.0)
    assert compared(one, [one, other], [], asked)[0] == (one,)


@pytest.mark.nightly
@pytest.mark.parametrize("seed,cause", [(241057, "drag.surge.cubic"), (234028, "drag.yaw.quadratic")])
def test_errors_of_the_thrust_do_not_give_a_drag_another_shape(seed, cause):
    """A hump in the place of a cubic drag and a linear drag in that of its square had led by 80 and 16 in chi-squared, of 480 and 315."""
    c = case(seed, "one")
    report = diagnose(parse_vehicle(c.text, "v.toml"), *logs_of_case(c), null_logs=0)
    assert any(cause in (f.effect, *f.alternatives) for f in report.findings)


def test_a_curve_has_to_beat_all_causes_over_its_velocity():
    """Damping of yaw of 252 in chi-squared beside a square of it, 2,500 together: a curve that explains 38 more is their shape, and one of 90 more is not."""
    alone = Curve(("drag.yaw.linear",), 252.0, 1, "any function of r in yaw", 290.0, directions=8, whole=252.0)
    assert BETTER_CURVE.refuses(alone) is not None
    assert BETTER_CURVE.refuses(replace(alone, whole=2500.0)) is None
    assert BETTER_CURVE.refuses(replace(alone, whole=2500.0, alone=342.0)) is not None


def test_a_cause_makes_place_only_for_one_that_came_next_to_it_and_leaves_nothing():
    def chosen(found, quiet=True):
        made = Selection(None, None, tuple(found), ())
        made.__dict__["after"] = SimpleNamespace(quiet=quiet)
        return made

    def found(id_, fall, tried=()):
        return Found(id_, (Rival(id_, None, 500.0 - fall, 1, fall),), dict.fromkeys(tried, 1.0), fall, 0.0, None)

    hump, cubic = found(HUMP.id, 126.0, ("drag.surge.cubic",)), found("drag.surge.cubic", 105.0)
    first = chosen([hump])
    (one,) = in_place(first, chosen([cubic]), frozenset({HUMP.id})).found
    assert [r.id for r in one.rivals] == ["drag.surge.cubic", HUMP.id]
    # It explains no more than the cause that it stands beside.
    assert one.rivals[1].fall == 105.0 and one.rivals[1].chi2 == one.rivals[0].chi2
    others = (chosen([]), chosen([cubic], quiet=False), chosen([found("thruster.lag", 90.0)]))
    assert all(in_place(first, other, frozenset({HUMP.id})) is first for other in others)
