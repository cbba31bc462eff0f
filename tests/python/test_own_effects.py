"""Effects of one's own, as docs/adding_an_effect.md tells it: its text is what is run here."""

import json
import re
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import command_line
from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS, logs_of, train_of, vehicle_of
from ivsid import IvsidError, diagnose, identify
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.cache import key_of
from ivsid.diagnosis.null.visibility import visibility
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.statements.extended import extended_text
from ivsid.effects import (
    EFFECTS,
    PLAIN_TERMS,
    Anchored,
    Effect,
    Force,
    Given,
    Grid,
    Harmonic,
    Hump,
    Key,
    Parameter,
    Response,
    Step,
    Term,
    Terms,
    own_digest,
    read_effects,
    register,
    spread,
    terms_of,
    unregister,
)
from ivsid.effects.scaling import froude_power
from ivsid.vehicle import parse_vehicle

GUIDE = (Path(__file__).parents[2] / "docs" / "adding_an_effect.md").read_text()
BLOCKS = {kind: re.findall(rf"```{kind}\n(.*?)```", GUIDE, re.DOTALL) for kind in ("python", "sh")}
MAIN = [sys.executable, "-c", "from ivsid.cli import main; main()"]


@pytest.fixture
def clean():
    before = dict(EFFECTS)
    yield
    for id_ in EFFECTS.keys() - before.keys():
        unregister(id_)
    # An effect that was taken out returns to its place: the examiner draws by it.
    EFFECTS.clear()
    EFFECTS.update(before)


def write_boat(folder):
    (folder / "boat.toml").write_text(TWIN + SENSORS)
    for name, seed in (("train", 21), ("test", 22)):
        head = f"duration = 240.0\nrate = 10.0\nseed = {seed}\n[truth]\n"
        (folder / f"{name}.toml").write_text(head + "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items()) + ZIGZAGS)


@pytest.mark.slow
def test_the_guide_does_what_it_says(tmp_path, monkeypatch):
    """Every command of the guide in turn, in a folder that holds its files: hidden, found, identified, and never called proved."""
    write_boat(tmp_path)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my_effects.py").write_text(BLOCKS["python"][0])
    commands = [line for block in BLOCKS["sh"] for line in block.splitlines()]
    assert len(commands) == 4

    def run(line):
        words, known = line.split(), set(EFFECTS)
        assert words[0] == "ivsid"
        made = command_line.run(*words[1:])
        # Each command of a shell begins without the effects of the last one.
        for id_ in set(EFFECTS) - known:
            unregister(id_)
        return made

    for line in commands:
        made = run(line)
        assert made.returncode == 0, (line, made.stderr)
    found = json.loads((tmp_path / "diagnosis" / "result.json").read_text())
    assert [f["effect"] for f in found["findings"]] == ["drag.surge.turning"]
    bound = found["findings"][0]["parameters"]["drag.surge.turning"]
    assert bound["lower"] <= 20.0 <= bound["upper"] and bound["unit"] == "kg s"
    assert [f["name"] for f in found["own_effects"]] == ["my_effects.py"]
    fit = json.loads((tmp_path / "fit" / "result.json").read_text())
    bound = fit["parameters"]["drag.surge.turning"]
    assert fit["guaranteed"] and bound["lower"] <= 20.0 <= bound["upper"]
    # The checker has no physics of it, and says so; the seal still holds.
    said = run("ivsid verify fit train/log.csv --out checked")
    assert said.returncode == 0 and "NOT CHECKED" in said.stdout and "drag.surge.turning" in said.stdout
    # Without the file the id means nothing, and the sentence says where it comes from.
    bare = run("ivsid identify diagnosis/model.toml train/log.csv --out bare")
    assert bare.returncode == 2 and "--own-effects" in bare.stderr and not (tmp_path / "bare").exists()


# Nightly: the gate screens it in test_diagnosis_stages.py.
@pytest.mark.slow
@pytest.mark.nightly
def test_a_force_with_two_channels_is_named(clean):
    """The guide's second example: no term, so no model lists it, but it is simulated and named."""
    names = {}
    exec(BLOCKS["python"][1], names)
    register(names["FIN"])
    vehicle = vehicle_of()
    result = diagnose(vehicle, *logs_of(vehicle, {"drag.stern_fin": 15.0}))
    assert result.findings and "drag.stern_fin" in {result.findings[0].effect, *result.findings[0].alternatives}
    bound = result.findings[0].parameters[result.findings[0].effect]
    if result.findings[0].effect == "drag.stern_fin":
        assert bound.lower <= 15.0 <= bound.upper


def test_a_registered_term_stands_in_a_model(clean):
    turning = Term("drag.surge.turning", "", "kg s", lambda s: {"surge": s.u * s.r * s.r})
    register(Effect("drag.surge.turning", "turning", (Parameter("", "", "kg s", 20.0),), Terms((turning,))))
    ids = [*TRUTH, "drag.surge.turning"]
    vehicle = vehicle_of(extra=f"[model]\nterms = {json.dumps(ids)}\n")
    assert [t.id for t in terms_of(vehicle)] == ids
    train = train_of(vehicle, {"drag.surge.turning": 20.0}, duration=60.0)
    fit = identify(vehicle, train)
    assert fit.status == "enclosed"
    for id_, value in {**TRUTH, "drag.surge.turning": 20.0}.items():
        assert fit.parameters[id_].lower <= value <= fit.parameters[id_].upper, id_
    unregister("drag.surge.turning")
    with pytest.raises(IvsidError, match="own-effects"):
        terms_of(vehicle)


# The catalogue's effects that a user writes down again under another id, one of each form, sensor and thruster, with the new id.
COPIED = {
    "drag.yaw.linear": "drag.own.turning",
    "thruster.delay": "thruster.bus",
    "thruster.lag": "thruster.spool",
    "thruster.deadband": "thruster.stiction",
    "thruster.saturation": "thruster.fuse",
    "thruster.failure": "thruster.weed",
    "thruster.advance_loss": "thruster.inflow",
    "payload.step": "payload.catch",
    "current.steady": "current.river",
    "current.oscillating": "current.seiche",
    "wave.force": "wave.swell",
    "drag.surge.hump": "drag.own.wash",
    "tether.tension": "tether.rope",
    "sensor.velocity.delay": "sensor.dvl.late",
    "sensor.velocity.lever_arm": "sensor.dvl.place",
    "sensor.yaw_rate.scale": "sensor.gyro.unit",
}


def copied(id_):
    """An effect of the catalogue under another id, as a user would write it by the guide."""
    ours, new = EFFECTS[id_], COPIED[id_]
    if id_ == "thruster.delay":
        # In full: a late demand says by itself how it is searched.
        return Effect(new, "a slow bus", (Parameter("", "", "s", 0.1, lowest=0.0),), Response("delay"))
    if id_ == "sensor.velocity.delay":
        names = {}
        exec(BLOCKS["python"][2], names)
        return names["FILTER"]
    if id_ == "thruster.failure":
        # Likewise a size with a start.
        return Effect(new, "weed on a screw", ours.parameters, ours.acts)
    terms = tuple(replace(t, id=new + t.id.removeprefix(id_)) for t in ours.terms)
    return replace(ours, id=new, acts=Terms(terms) if terms else ours.acts)


def test_an_effect_of_ones_own_scores_as_ours_does(clean):
    """The same physics under another id has the same fall, numbers, chance and visibility, whatever its form."""
    register(*map(copied, COPIED))
    vehicle = vehicle_of()
    # A late thrust and a band leave errors in which every cause explains something.
    hidden = {"thruster.delay": 0.15, "thruster.deadband": 6.0}
    fit = plain_fit(vehicle, channels(train_of(vehicle, hidden, duration=150.0), vehicle), everything)
    scored = {s.id: s for s in score(fit)[1]}
    seen = visibility(fit)
    falls = []
    for id_, new in COPIED.items():
        ours, own = scored[id_], scored[new]
        falls.append(ours.fall)
        # Columns of the same numbers in other places of a matrix product differ by rounding.
        assert own.fall == pytest.approx(ours.fall, rel=1e-6, abs=1e-6), id_
        assert own.values == pytest.approx(ours.values, rel=1e-6, abs=1e-6), id_
        assert (own.count, own.looks, own.physical) == (ours.count, ours.looks, ours.physical), id_
        assert own.chance == pytest.approx(ours.chance, rel=1e-4), id_
        assert (id_ in seen) == (new in seen)
        if id_ in seen:
            assert seen[new].z == pytest.approx(seen[id_].z, rel=1e-6) and seen[new].blind == seen[id_].blind, id_
            assert [*seen[new].detectable.values()] == pytest.approx([*seen[id_].detectable.values()], rel=1e-6), id_
    assert sum(f > 25.0 for f in falls) > len(falls) / 2


@pytest.mark.parametrize("id_", ["thruster.delay", "thruster.deadband", "thruster.failure", "payload.step"])
def test_an_effect_of_ones_own_is_simulated_as_ours_is(id_, clean):
    register(copied(id_))
    vehicle = vehicle_of()
    numbers = {
        "thruster.delay": (0.13,),
        "thruster.deadband": (9.0,),
        "thruster.failure": (1.0, 0.4, 33.3),
        "payload.step": (5.0, 33.3),
    }[id_]
    ours, own = (train_of(vehicle, spread(i, numbers), duration=60.0) for i in (id_, COPIED[id_]))
    for name, column in ours.columns.items():
        assert column.tobytes() == own.columns[name].tobytes(), name


# Nightly: the gate compares the scores.
@pytest.mark.slow
@pytest.mark.nightly
def test_an_effect_of_ones_own_stands_beside_ours(clean):
    """Two names of one physics are one finding with an alternative, half as sure."""
    register(copied("thruster.delay"))
    vehicle = vehicle_of()
    result = diagnose(vehicle, *logs_of(vehicle, {"thruster.delay": 0.3}), null_logs=0)
    named = [(f.effect, *f.alternatives) for f in result.findings]
    assert [set(n) for n in named] == [{"thruster.delay", COPIED["thruster.delay"]}]
    assert result.findings[0].confidence == pytest.approx(0.5, abs=0.01)


# Nightly: the gate compares the scores, of which all else follows.
@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize(
    ("id_", "hidden"),
    [
        ("thruster.delay", {"thruster.delay": 0.3}),
        ("sensor.velocity.delay", {"sensor.velocity.delay": 0.2}),
        (
            "thruster.failure",
            {"thruster.failure.thruster": 1.0, "thruster.failure.loss": 0.3, "thruster.failure.time": 100.0},
        ),
        ("sensor.velocity.lever_arm", {"sensor.velocity.lever_arm.x": 0.2, "sensor.velocity.lever_arm.y": 0.05}),
    ],
)
def test_an_effect_of_ones_own_is_named_as_ours_is(id_, hidden, clean, monkeypatch):
    """With ours out of the catalogue, the same finding stands under the other id, with the same interval."""
    vehicle = vehicle_of()
    logs = logs_of(vehicle, hidden)
    ours = diagnose(vehicle, *logs, null_logs=0)
    register(copied(id_))
    monkeypatch.delitem(EFFECTS, id_)
    own = diagnose(vehicle, *logs, null_logs=0)
    assert [f.effect for f in ours.findings] == [id_] and [f.effect for f in own.findings] == [COPIED[id_]]
    for a, b in zip(ours.findings[0].parameters.values(), own.findings[0].parameters.values(), strict=True):
        # The noise is learnt beside candidates that stand in another order.
        assert (b.lower, b.upper) == pytest.approx((a.lower, a.upper), rel=1e-3, abs=1e-3)


def test_a_key_states_an_effect_of_ones_own_in_the_extended_file(clean, monkeypatch):
    """A user's effect with the key of a vehicle file is written under that key, and replaces what the file states."""
    register(copied("thruster.lag"))
    h = Hypothesis(PLAIN_TERMS, TRUTH, (Given(EFFECTS["thruster.spool"], (0.4,)),))
    made = parse_vehicle(extended_text(vehicle_of(), h), "model.toml")
    assert {t.time_constant for t in made.thrusters} == {0.4}


def effect(id_="drag.own", unit="kg/m", acts=None, typical=1.0, cause="a cause", **described):
    acts = acts or Force(lambda s, p: {"surge": -p[0] * s.u})
    return Effect(id_, cause, (Parameter("", "", unit, typical),), acts, **described)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (effect("Drag"), "is not usable"),
        (effect("drag.surge.linear"), "already"),
        (effect("drag.surge.linear.more"), "part of drag.surge.linear"),
        (effect("thruster"), "is not usable"),
        (effect(unit="furlong"), "unit 'furlong'"),
        (effect(typical=0.0), "typical size"),
        (effect(cause=" "), "cause in a sentence"),
        (effect(acts=Force(lambda s, p: {"heave": s.u})), "by channel"),
        (effect(acts=Force(lambda s, p: {})), "by channel"),
        (effect(acts=Force(lambda s, p: {"surge": s.speed})), "fails where it is tried"),
        (effect(acts=Force(lambda s, p: {"surge": float("nan")})), "finite number"),
        (effect(acts=Terms((Term("drag.other", "", "kg/m", lambda s: {"surge": s.u}),))), "ask for drag.own"),
        (effect(equivalents=("drag.surge.linear",), equivalent_odds=(1.0, 0.3)), "2 equivalent_odds and 1 equivalents"),
        (effect(searched=Harmonic("force")), "searched as Harmonic; that form asks for the parts period, phase"),
        (effect(searched=Anchored()), "asks for a pull, a place"),
        (effect(searched=Hump()), "searched as Hump; that form asks for the parts height"),
        (effect(searched=Step()), "one of draw time"),
        (effect(searched=Grid("thrust")), "acts at no thruster"),
        (
            replace(
                effect(),
                parameters=(Parameter("a", "", "N", 1.0), Parameter("b", "", "N", 1.0)),
                searched=Grid("seconds"),
            ),
            "a single parameter",
        ),
        (effect(per_thruster=True), "one of single thrusters"),
        (effect(key=Key("colour")), "which no thruster has"),
        (effect(measured=effect("drag.else")), "a measured form of the id drag.else"),
    ],
)
def test_what_is_wrong_with_an_effect_is_said_and_nothing_is_registered(wrong, words, clean):
    before = list(EFFECTS)
    with pytest.raises(IvsidError, match=words):
        register(effect("drag.right"), wrong)
    assert list(EFFECTS) == before


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("def", "is not Python"),
        ("1 / 0", "ZeroDivisionError"),
        ("EFFECTS = 3", "no list EFFECTS"),
        ("", "no list EFFECTS"),
    ],
)
def test_a_file_that_is_no_list_of_effects_is_refused(text, words, tmp_path, clean):
    path = tmp_path / "own.py"
    path.write_text(text)
    with pytest.raises(IvsidError, match=words):
        read_effects(path)
    with pytest.raises(IvsidError, match="cannot be read"):
        read_effects(tmp_path / "absent.py")


def test_null_logs_are_kept_under_the_content_of_the_files(tmp_path, clean):
    """The same id with other physics asks for null logs of its own; what came from no file is not kept at all."""
    assert own_digest() == ""
    path = tmp_path / "own.py"
    said = []
    for body in (BLOCKS["python"][0], BLOCKS["python"][0].replace("square(s.r)", "abs(s.r)")):
        path.write_text(body)
        read_effects(path)
        said.append(own_digest())
        unregister("drag.surge.turning")
    assert own_digest() == "" and len({"", None, *said}) == 4
    vehicle = vehicle_of()
    train = train_of(vehicle, duration=90.0)
    log = channels(train, vehicle)
    plain = key_of(vehicle, log, 1, 0.005, frozenset({"wind.steady"}), 1e-4)
    read_effects(path)
    assert key_of(vehicle, log, 1, 0.005, frozenset({"wind.steady"}), 1e-4) != plain
    register(effect("drag.own"))
    assert own_digest() is None


def test_sizes_scale_after_froude_from_the_unit_alone():
    """The powers of docs/theory.md, "The catalogue of effects": forces L^3, moments L^4, speeds and times L^0.5."""
    known = {
        "kg": 3, "kg m": 4, "kg m^2": 5, "kg/m": 2, "kg/m^2": 1, "kg/s": 2.5, "kg m/s": 3.5, "N": 3, "N m s": 4.5, "N m s^2": 5,
        "N/(m/s)^2": 2, "N/(m/s)^3": 1.5, "m": 1, "s": 0.5, "1/s": -0.5, "m/s": 0.5, "s/m": -0.5, "rad/s": -0.5, "m/s^2": 0,
        "m/s^2 per N": -3, "rad": 0, "1": 0, "demand": 0,
    }  # fmt: skip
    assert {u: froude_power(u) for u in known} == known
    for unit in ("", "/m", "m/", "kg//m", "(kg", "kg)", "kg^", "lb", "per N", "m per"):
        with pytest.raises(IvsidError, match="not understood"):
            froude_power(unit)
