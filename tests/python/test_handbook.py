"""The handbook of effects: every effect has its entry and its figure, and both are what the code makes."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from ivsid.effects import EFFECTS
from sampling import spaced

DOCS = Path(__file__).parents[2] / "docs"
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


@pytest.fixture(scope="module")
def handbook():
    sys.path.insert(0, str(DOCS))
    try:
        import handbook
    finally:
        sys.path.remove(str(DOCS))
    return handbook


@pytest.fixture(scope="module")
def made(handbook):
    return {e.id: handbook.signature(e) for e in EFFECTS.values()}


# Nightly: the signatures of all effects are made anew.
@pytest.mark.nightly
def test_the_page_is_what_the_code_writes_with_an_entry_for_every_effect(handbook, made):
    text = (DOCS / "effects_handbook.md").read_text(encoding="utf-8")
    assert handbook.page(made) == text, "run make handbook"
    assert sorted(re.findall(r"^### (\S+)$", text, re.MULTILINE)) == sorted(EFFECTS)
    for effect in EFFECTS.values():
        entry = text.split(f"### {effect.id}\n")[1].split("\n### ")[0]
        assert all(f"`{part}`" in entry for part in effect.parts), effect.id
        for other in (*effect.equivalents, *effect.confusable):
            assert other in entry, effect.id
        assert effect.separate in entry and f"effects/{effect.id}.svg" in entry, effect.id


@pytest.mark.figures
@pytest.mark.nightly
def test_every_figure_is_there_small_and_the_one_that_the_code_draws(handbook, made):
    """Another machine's sine may move a line by a tenth of a point; nothing more."""
    files = {p.stem for p in (DOCS / "effects").glob("*.svg")}
    assert files == set(EFFECTS)
    assert sum(p.stat().st_size for p in (DOCS / "effects").iterdir()) < 1e6
    for id_, s in spaced(made.items(), 8):
        there, here = (DOCS / "effects" / f"{id_}.svg").read_text(encoding="utf-8"), handbook.drawn(s)
        if there != here:
            assert NUMBER.sub("", there) == NUMBER.sub("", here), f"{id_}: run make handbook"
            a, b = (np.array([float(q) for q in NUMBER.findall(x)]) for x in (there, here))
            assert np.abs(a - b).max() <= 0.2, f"{id_}: run make handbook"


@pytest.mark.nightly
def test_signatures_say_what_is_known_of_them(made):
    """Effects that the fit takes whole, effects that it cannot touch, and the quantity that orders each family."""
    for id_ in ("thruster.gain", "environment.shallow_water"):
        assert made[id_].share < 1e-3, id_
    for id_, effect in EFFECTS.items():
        assert (made[id_].share is None) == id_.startswith("sensor."), id_
        if id_ not in ("thruster.gain", "environment.shallow_water"):
            assert made[id_].share is None or made[id_].share > 0.02, id_
        assert np.abs(made[id_].whole).max() > 0, id_
        assert effect.plain or made[id_].channel in ("X", "Y", "N", "K1", "K2", "K3")
    ordered = {id_: s.quantity for id_, s in made.items()}
    assert ordered["drag.surge.linear"] == ordered["friction.coulomb"] == "u"
    assert ordered["drag.yaw.linear"] == ordered["drag.yaw.quadratic"] == "r"
    assert ordered["current.steady"] == ordered["wind.steady"] == "heading"
    assert ordered["sensor.acceleration.bias"] == "time" and made["sensor.acceleration.bias"].channel == "K1"
    # A constant reading is exactly that, and linear drag is 4 kg/s times u before anything is fitted.
    bias = made["sensor.acceleration.bias"].left
    assert bias == pytest.approx(EFFECTS["sensor.acceleration.bias"].parameters[0].typical, rel=1e-6)
    linear = made["drag.surge.linear"]
    assert np.abs(linear.whole + 4.0 * linear.values).max() < 0.05 * np.abs(linear.whole).max()
    # Odd signatures are odd: what is left along u crosses zero with u.
    assert (
        made["friction.coulomb"].whole[linear.values > 0.5].max()
        < 0
        < made["friction.coulomb"].whole[linear.values < -0.3].min()
    )


def test_traits_are_asked_of_the_physics(handbook):
    said = {e.id: handbook.traits(e) for e in EFFECTS.values()}
    assert said["drag.surge.linear"] == ["odd: reversed with the motion"]
    assert said["drag.surge.sideslip"] == ["even: the same when the motion is reversed"]
    assert said["drag.surge.astern"] == ["of one direction only"]
    assert said["wind.steady"] == ["depends on the heading"]
    assert "depends on the place" in said["tether.tension"] and "depends on the clock" in said["wave.force"]
    assert said["thruster.lag"] == said["thruster.shaft_lag"] == said["thruster.delay"] == ["has memory"]
    for id_ in ("payload.step", "fouling.drift", "thruster.failure", "thruster.voltage_sag", "current.oscillating"):
        assert "depends on the clock" in said[id_], id_
    for id_ in ("thruster.gain", "thruster.curve", "environment.shallow_water", "current.steady"):
        assert "depends on the clock" not in said[id_], id_
