"""The catalogue: complete, described, and each effect leaves its mark where its definition says."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.effects import CATALOGUE, EFFECTS, Effect, Parameter, Reading, Terms, register, sort_given, spread
from ivsid.effects.effect import Force
from ivsid.effects.functions import cross_flow_force, cross_flow_moment, cross_flow_value
from ivsid.intervals import IntervalArray
from ivsid.programme.scenario import parse_scenario
from ivsid.rows.motion import Motion
from ivsid.simulation import hidden_effect, simulate
from ivsid.simulation.hidden import can_hide, draw
from ivsid.vehicle import parse_vehicle

# The catalogue (docs/theory.md, "The catalogue of effects"), family by family.
PLAIN = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic"]
IDS = [
    "drag.surge.linear",
    "drag.surge.cubic",
    "drag.surge.hump",
    "friction.coulomb",
    "drag.surge.astern",
    "drag.surge.sideslip",
    "drag.sway.linear",
    "drag.sway.cubic",
    "drag.sway.yaw_rate",
    "drag.yaw.linear",
    "drag.yaw.quadratic",
    "drag.yaw.cubic",
    "drag.cross_flow",
    "drag.lift.sway",
    "drag.lift.yaw",
    "coupling.cg_x",
    "coupling.cg_y",
    "added_mass.munk",
    "payload.step",
    "current.steady",
    "current.oscillating",
    "wind.steady",
    "wave.force",
    "environment.shallow_water",
    "tether.tension",
    "fouling.drift",
    "thruster.gain",
    "thruster.asymmetry",
    "thruster.failure",
    "thruster.deadband",
    "thruster.saturation",
    "thruster.lag",
    "thruster.shaft_lag",
    "thruster.delay",
    "thruster.advance_loss",
    "thruster.reverse_loss",
    "thruster.voltage_sag",
    "thruster.curve",
    "sensor.acceleration.bias",
    "sensor.acceleration.lever_arm",
    "sensor.attitude_leak",
    "sensor.yaw_rate.bias",
    "sensor.yaw_rate.scale",
    "sensor.velocity.scale",
    "sensor.velocity.misalignment",
    "sensor.velocity.lever_arm",
    "sensor.velocity.delay",
]
PARTS = {
    "drag.surge.hump": "height speed width",
    "payload.step": "mass time",
    "current.steady": "north east",
    "current.oscillating": "north east period phase",
    "wind.steady": "north east",
    "wave.force": "amplitude period phase direction",
    "tether.tension": "force anchor_north anchor_east arm",
    "thruster.failure": "thruster loss time",
    "sensor.acceleration.bias": "x y",
    "sensor.acceleration.lever_arm": "x y",
    "sensor.velocity.lever_arm": "x y",
}

TWIN = """
name = "nominal"
[hull]
mass = 50
length = 1.2
[[thrusters]]
name = "port"
position = [-0.4, -0.28]
quadratic = { forward = 0.005, reverse = 0.0035 }
demand_range = [-100, 100]
[[thrusters]]
name = "starboard"
position = [-0.4, 0.28]
quadratic = { forward = 0.005, reverse = 0.0035 }
demand_range = [-100, 100]
[sensors]
[sensors.velocity]
accuracy = 0.002
[sensors.acceleration]
random_walk = 0.002
[sensors.yaw_rate]
random_walk = 0.001
[sensors.heading]
accuracy = 0.005
[sensors.position]
accuracy = 0.5
"""
RICH = """
duration = 80.0
rate = 10.0
noise = "none"
[truth]
"mass.surge" = 58.0
"mass.sway" = 75.0
"inertia.yaw" = 9.0
"drag.surge.quadratic" = 28.0
"drag.sway.quadratic" = 150.0
[[segments]]
manoeuvre = "prbs"
demand = 40
amplitude = 35
differential = 15
period = 2.0
yaw_gain = 30.0
differential_limit = 40.0
duration = 20.0
[[segments]]
manoeuvre = "steps"
demand = [80, -60, 4]
differential = [3, 3, 1]
yaw_gain = 30.0
differential_limit = 40.0
duration = 20.0
"""


@pytest.fixture(scope="module")
def nominal():
    return parse_vehicle(TWIN, "nominal.toml")


@pytest.fixture(scope="module")
def rich():
    return parse_scenario(RICH, "rich.toml")


@pytest.fixture(scope="module")
def undisturbed(nominal, rich):
    return simulate(nominal, rich, 1)


def test_the_catalogue_is_that_of_the_contract():
    assert [e.id for e in EFFECTS.values() if e.plain] == ["mass.surge", "mass.sway", "inertia.yaw", *PLAIN[3:]]
    assert {e.id for e in EFFECTS.values() if not e.plain} == set(IDS) and len(IDS) == 47
    for id_, effect in EFFECTS.items():
        parts = [f"{id_}.{p}" for p in PARTS[id_].split()] if id_ in PARTS else [id_]
        assert list(effect.parts) == parts
        assert len(effect.cause) > 10 and effect.separate, id_
        assert {*effect.equivalents, *effect.confusable} <= set(EFFECTS), id_
        for form in filter(None, (effect, effect.measured)):
            for p in form.parameters:
                assert p.scaled(58.0) == pytest.approx(p.typical), id_  # the unit is known, the reference is itself
    assert set(CATALOGUE) <= set(EFFECTS)


def test_sizes_scale_after_froude():
    # A vehicle eight times as heavy is twice as long: forces times 8, moments of damping by the powers of their units.
    one = {e.id: e.parameters[0] for e in EFFECTS.values()}
    eight = 8 * 58.0
    assert one["friction.coulomb"].scaled(eight) == pytest.approx(8 * 1.0)
    assert one["drag.surge.quadratic"].scaled(eight) == pytest.approx(4 * 28.0)
    assert one["current.steady"].scaled(eight) == pytest.approx(np.sqrt(2) * 0.08)
    assert one["sensor.yaw_rate.bias"].scaled(eight) == pytest.approx(0.01 / np.sqrt(2))


@pytest.mark.parametrize("id_", IDS)
def test_each_effect_leaves_its_mark_and_no_other_column(nominal, rich, undisturbed, id_):
    """At typical size each effect moves what its definition says: readings alone, or the motion itself."""
    effect = EFFECTS[id_]
    assert can_hide(effect, nominal, rich)
    values = draw(effect, 1.0, nominal, rich, np.random.default_rng(5))
    made = simulate(nominal, rich, 1, values)
    assert made.truth["effects"] == values
    assert list(made.columns) == list(undisturbed.columns), "the columns must not tell"
    changed = {n for n, x in made.columns.items() if not np.array_equal(x, undisturbed.columns[n])}
    moved = np.abs(made.exact["u"] - undisturbed.exact["u"]).max()
    if isinstance(effect.acts, Reading):
        assert moved == 0, "a sensor moves nothing"
        expected = {"velocity": {"u", "v"}, "acceleration": {"ax", "ay"}, "yaw_rate": {"r"}}[effect.acts.sensor]
        assert changed and changed <= expected
    else:
        scale = max(np.abs(made.exact[n] - undisturbed.exact[n]).max() for n in ("u", "v", "r"))
        assert 1e-4 < scale < 1.5, id_
        assert {"u", "v", "r", "ax", "ay"} & changed


@pytest.mark.parametrize("id_", IDS)
def test_no_effect_at_the_size_of_none(nominal, rich, undisturbed, id_):
    """At a vanishing size the motion is that without the effect: what is drawn beside the size adds nothing of its own."""
    values = draw(EFFECTS[id_], 1e-9, nominal, rich, np.random.default_rng(5))
    made = simulate(nominal, rich, 1, values)
    # The acceleration just after a step of the demand tells any lag from none.
    for name in ("u", "v", "r") if id_ in ("thruster.lag", "thruster.shaft_lag") else ("u", "v", "r", "ax", "ay"):
        np.testing.assert_allclose(made.columns[name], undisturbed.columns[name], atol=2e-5)


def test_hidden_effects_cover_the_catalogue(nominal, rich):
    drawn = [hidden_effect(nominal, rich, seed) for seed in range(1500)]
    none = sum(not d for d in drawn)
    assert 430 < none < 570, "none in one of three"
    ids = {g.effect.id for d in drawn for g in sort_given(d, ["port", "starboard"])}
    assert ids == set(IDS)
    gains = np.array([d["drag.surge.linear"] for d in drawn if "drag.surge.linear" in d])
    typical = EFFECTS["drag.surge.linear"].parameters[0].scaled(nominal.hull.mass)
    assert (0.1 * typical <= gains).all() and (gains <= 3 * typical).all() and gains.size > 10
    assert hidden_effect(nominal, rich, 3) == hidden_effect(nominal, rich, 3)


def test_what_stands_in_the_model_or_the_truth_is_not_hidden(nominal, rich, swan):
    with_drag = rich.model_copy(update={"truth": {**rich.truth, "drag.surge.linear": 3.0, "wave.force.period": 3.0}})
    assert not can_hide(EFFECTS["drag.surge.linear"], nominal, with_drag)
    assert not can_hide(EFFECTS["wave.force"], nominal, with_drag)
    paper = rich.model_copy(update={"truth": {k: v for k, v in rich.truth.items() if "sway" not in k}})
    assert not can_hide(EFFECTS["mass.sway"], nominal, rich) and not can_hide(EFFECTS["mass.sway"], nominal, paper)
    assert can_hide(EFFECTS["mass.sway"], swan, paper) and can_hide(EFFECTS["drag.sway.quadratic"], swan, paper)
    assert not can_hide(EFFECTS["mass.surge"], swan, paper)
    bare = nominal.model_copy(update={"hull": nominal.hull.model_copy(update={"length": None})})
    assert not can_hide(EFFECTS["drag.cross_flow"], bare, rich)
    with pytest.raises(IvsidError, match=r"hull\.length"):
        simulate(bare, rich, 1, {"drag.cross_flow": 20.0})


def test_numbers_are_spread_and_sorted():
    assert spread("current.steady", [0.1, 0.2]) == {"current.steady.north": 0.1, "current.steady.east": 0.2}
    assert spread("wind.steady", [0.1, 0.2], measured=True) == {"wind.steady.surge": 0.1, "wind.steady.sway": 0.2}
    with pytest.raises(IvsidError, match=r"takes 2 numbers \(current.steady.north \[m/s\]"):
        spread("current.steady", [0.1])
    for values, sentence in (
        ({"drag.magic": 1.0}, "'drag.magic' is not simulated"),
        ({"current.steady.north": 1.0}, "needs current.steady.north and current.steady.east; east is missing"),
        ({"current.steady.up": 1.0}, "has no part up; its parts are north, east"),
        ({"thruster.lag.bow": 1.0}, "has no thruster bow; it has port"),
        ({"drag.surge.linear.port": 1.0}, "has no part port; it is a single number"),
        ({"thruster.lag": -1.0}, "must not be below 0"),
        (
            {"wave.force.amplitude": 1, "wave.force.period": 0, "wave.force.phase": 0, "wave.force.direction": 0},
            "above 0",
        ),
        (
            {"thruster.failure.thruster": 0.5, "thruster.failure.loss": 1, "thruster.failure.time": 0},
            "place in the file",
        ),
    ):
        with pytest.raises(IvsidError, match=sentence):
            sort_given(values, ["port"])


def test_one_may_add_an_effect(nominal, rich, undisturbed):
    quartic = Effect(
        "drag.surge.quartic",
        "a drag outside the catalogue",
        (Parameter("", "", "N/(m/s)^4", 5.0),),
        Force(lambda s, p: {"surge": -(s.u * s.u * s.u * abs(s.u)) * p[0]}),
    )
    register(quartic)
    try:
        made = simulate(nominal, rich, 1, {"drag.surge.quartic": 5.0})
        assert np.abs(made.exact["u"]).max() < np.abs(undisturbed.exact["u"]).max()
        with pytest.raises(IvsidError, match="in the catalogue already"):
            register(quartic)
    finally:
        del EFFECTS["drag.surge.quartic"]


def test_cross_flow_in_closed_form_and_in_intervals():
    rng = np.random.default_rng(0)
    x = np.linspace(-0.6, 0.6, 400_001)
    for v, r in [(0.0, 0.0), (0.5, 0.0), (-0.3, 1e-12), (0.0, 1.0), *rng.uniform(-1, 1, (20, 2))]:
        flow = (v + x * r) * abs(v + x * r)
        for power, integrand in ((0, flow), (1, x * flow)):
            exact = np.trapezoid(integrand, x)
            assert cross_flow_value(float(v), float(r), 0.6, power) == pytest.approx(exact, abs=1e-9)
    v, r = rng.uniform(-1, 1, (2, 50))
    r[:5] = v[3:8] = 0.0
    for function, power in ((cross_flow_force, 0), (cross_flow_moment, 1)):
        one_by_one = [cross_flow_value(float(a), float(b), 0.6, power) for a, b in zip(v, r, strict=True)]
        np.testing.assert_allclose(function(v, r, 0.6), one_by_one, rtol=1e-12, atol=1e-15)
    boxes = [IntervalArray(q - 0.01, q + 0.01) for q in (v, r)]
    for function in (cross_flow_force, cross_flow_moment):
        enclosure = function(*boxes, 0.6)
        assert enclosure.contains(function(v, r, 0.6)).all()
        moving = function(*(Motion(b, IntervalArray(-0.1, 0.1)) for b in boxes), 0.6)
        assert moving.value.contains(function(v, r, 0.6)).all()
    # Strips of a fortieth of the length were up to 1.2 wide here.
    assert enclosure.width.max() < 0.05


def test_terms_act_by_their_column(nominal, rich):
    """The motion feels a term by its column at the state: m udot changes by parameter times column."""
    base = simulate(nominal, rich, 1)
    start = {"u": 0.8, "v": -0.2, "r": 0.3}
    scenario = rich.model_copy(update={"start": rich.start.model_copy(update=start)})
    base = simulate(nominal, scenario, 1)
    from ivsid.effects import State

    mass = {"surge": 58.0, "sway": 75.0, "yaw": 9.0}
    for id_ in IDS:
        acts = EFFECTS[id_].acts
        if not isinstance(acts, Terms) or id_ in ("wind.steady", "drag.cross_flow") or id_.startswith("coupling"):
            continue
        made = simulate(nominal, scenario, 1, {id_: 2.0})
        columns = acts.terms[0].columns(State(0.8, -0.2, 0.3, 0.0, 0.0, 0.0))
        for channel, rate in (("surge", "udot"), ("sway", "vdot"), ("yaw", "rdot")):
            felt = -mass[channel] * (made.exact[rate][0] - base.exact[rate][0])
            assert felt == pytest.approx(2.0 * columns.get(channel, 0.0), abs=1e-9), (id_, channel)


def test_a_described_effect_keeps_its_form():
    with pytest.raises(AttributeError):
        EFFECTS["mass.surge"].id = "x"
    assert replace(EFFECTS["mass.surge"], cause="y").cause == "y"


def test_the_handbook_says_what_the_code_does():
    from pathlib import Path

    page = (Path(__file__).parents[2] / "docs" / "effects.md").read_text()
    for effect in EFFECTS.values():
        row = next(line for line in page.splitlines() if line.startswith(f"| `{effect.id}`"))
        if not effect.plain:
            table = page[page.index("## The catalogue") :]
            row = next(line for line in table.splitlines() if line.startswith(f"| `{effect.id}`"))
            assert effect.cause in row and effect.separate in row
            assert all(f"[{p.unit}]" in row for p in effect.parameters)


@pytest.mark.parametrize("length", ["1.09", "1.2", "0.3", "2.7182818284590452353"])
def test_cross_flow_holds_the_decimals_of_the_length(length):
    """With w = v + x r of one sign the integrals are v^2 L + r^2 L^3 / 12 and v r L^3 / 6, exactly."""
    v, r, exact = Fraction(1), Fraction(1, 4), Fraction(length)
    boxes = IntervalArray(np.array(1.0)), IntervalArray(np.array(0.25))
    half = 0.5 * float(length)
    force, moment = cross_flow_force(*boxes, half), cross_flow_moment(*boxes, half)
    for found, truth in (
        (force, v * v * exact + r * r * exact**3 / 12),
        (moment, v * r * exact**3 / 6),
    ):
        assert Fraction(float(found.lower)) <= truth <= Fraction(float(found.upper))
