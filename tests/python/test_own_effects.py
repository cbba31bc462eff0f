"""Effects of one's own, as docs/adding_an_effect.md tells it: its text is what is run here."""

import json
import re
import sys
from pathlib import Path

import pytest

import command_line
from diagnosis_logs import SENSORS, TRUTH, TWIN, ZIGZAGS, logs_of, train_of, vehicle_of
from ivsid import IvsidError, diagnose, identify
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.null.cache import key_of
from ivsid.effects import (
    EFFECTS,
    Effect,
    Force,
    Parameter,
    Term,
    Terms,
    own_digest,
    read_effects,
    register,
    terms_of,
    unregister,
)
from ivsid.effects.scaling import froude_power

GUIDE = (Path(__file__).parents[2] / "docs" / "adding_an_effect.md").read_text()
BLOCKS = {kind: re.findall(rf"```{kind}\n(.*?)```", GUIDE, re.DOTALL) for kind in ("python", "sh")}
MAIN = [sys.executable, "-c", "from ivsid.cli import main; main()"]


@pytest.fixture
def clean():
    before = set(EFFECTS)
    yield
    for id_ in set(EFFECTS) - before:
        unregister(id_)


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
    assert [f["effect"] for f in found["findings"]] == ["drag.surge.cubic"]
    bound = found["findings"][0]["parameters"]["drag.surge.cubic"]
    assert bound["lower"] <= 8.0 <= bound["upper"] and bound["unit"] == "N/(m/s)^3"
    assert [f["name"] for f in found["own_effects"]] == ["my_effects.py"]
    fit = json.loads((tmp_path / "fit" / "result.json").read_text())
    bound = fit["parameters"]["drag.surge.cubic"]
    assert fit["guaranteed"] and bound["lower"] <= 8.0 <= bound["upper"]
    # The checker has no physics of it, and says so; the seal still holds.
    said = run("ivsid verify fit train/log.csv --out checked")
    assert said.returncode == 0 and "NOT CHECKED" in said.stdout and "drag.surge.cubic" in said.stdout
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
    cubic = Term("drag.surge.cubic", "", "N/(m/s)^3", lambda s: {"surge": s.u * s.u * s.u})
    register(Effect("drag.surge.cubic", "cubic", (Parameter("", "", "N/(m/s)^3", 8.0),), Terms((cubic,))))
    ids = [*TRUTH, "drag.surge.cubic"]
    vehicle = vehicle_of(extra=f"[model]\nterms = {json.dumps(ids)}\n")
    assert [t.id for t in terms_of(vehicle)] == ids
    train = train_of(vehicle, {"drag.surge.cubic": 8.0}, duration=60.0)
    fit = identify(vehicle, train)
    assert fit.status == "enclosed"
    for id_, value in {**TRUTH, "drag.surge.cubic": 8.0}.items():
        assert fit.parameters[id_].lower <= value <= fit.parameters[id_].upper, id_
    unregister("drag.surge.cubic")
    with pytest.raises(IvsidError, match="own-effects"):
        terms_of(vehicle)


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
    for body in (BLOCKS["python"][0], BLOCKS["python"][0].replace("square(s.u)", "abs(s.u)")):
        path.write_text(body)
        read_effects(path)
        said.append(own_digest())
        unregister("drag.surge.cubic")
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
