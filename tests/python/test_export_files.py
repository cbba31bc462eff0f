"""Files of the exports: what they hold and cannot hold, intervals, names as text, and unusable results."""

import ast
import json
import re
import xml.etree.ElementTree as ET
from fractions import Fraction

import numpy as np
import pytest

import ivsid
from command_line import run
from exported_boat import CUBIC, DAMPED, TABLE, TRUTH, WHOLE, boat
from ivsid import Interval, IvsidError
from ivsid.exports import TARGETS
from ivsid.exports.number import Number
from ivsid.exports.planar import planar_of
from ivsid.identification import read_identification
from ivsid.vehicle import parse_vehicle
from other_simulators import matlab, pvs


def test_yaml_holds_everything():
    yaml = pytest.importorskip("yaml")
    vehicle = boat({**WHOLE, "thruster.delay": 0.3}, TABLE, extra="dead_band = 12.0")
    made = ivsid.export(vehicle, "yaml")
    read = yaml.safe_load(made.text)
    assert made.unstated == () and set(read["numbers"]) >= {*WHOLE, "thruster.delay", "thruster.deadband.port"}
    assert read["numbers"]["mass.surge"] == {
        "value": 58.0,
        "lower": 57.75,
        "upper": 58.5,
        "unit": "kg",
        "symbol": "m - X_udot",
    }
    port = read["thrusters"][0]
    assert port["position"] == [-0.35, -0.3] and port["table"]["thrust"][-1] == 40.0 and port["dead_band"] == 12.0
    assert read["hull"]["mass"] == 50.0 and read["hull"]["centre_of_gravity"] == [0.05, -0.02]


NEVER = ("thruster.delay = 0.3 s", "sensor.yaw_rate.bias = 0.01 rad/s", "drag.cross_flow = 25 kg/m^2")


@pytest.mark.parametrize("target", [t.name for t in TARGETS if t.name != "yaml"])
def test_what_a_target_cannot_say_is_said_in_the_file_and_in_the_result(target):
    vehicle = boat({**TRUTH, "thruster.delay": 0.3, "sensor.yaw_rate.bias": 0.01, "drag.cross_flow": 25.0})
    made = ivsid.export(vehicle, target)
    for words in NEVER:
        assert any(s.startswith(words) for s in made.unstated)
        assert words in made.text
    assert all(s.replace("--", "- -") in made.text for s in made.unstated)


@pytest.mark.parametrize("target", [t.name for t in TARGETS])
def test_cubic_drags_stand_in_files_of_equations_and_are_unstated_elsewhere(target):
    """Plugins of Gazebo and VRX have matrices of linear and quadratic damping alone, Stonefish has the drag of a mesh."""
    made = ivsid.export(boat({**TRUTH, **CUBIC}), target)
    missing = {i for i in CUBIC if any(s.startswith(f"{i} = {CUBIC[i]:g} ") for s in made.unstated)}
    assert missing == (set() if target in ("mss", "pvs", "yaml") else set(CUBIC))


@pytest.mark.parametrize(
    ("target", "words"),
    [("gz", "7.75 to 8.5 kg"), ("vrx", "7.75 to 8.5 kg"), ("mss", "-8.5 to -7.75 kg"), ("pvs", "-8.5 to -7.75 kg")],
)
def test_intervals_go_with_their_numbers(target, words):
    """The added mass in surge is the whole less 50 kg; its ends turn with its sign."""
    line = next(
        q for q in ivsid.export(boat({**TRUTH, **DAMPED}), target).text.splitlines() if "X_udot" in q and "to" in q
    )
    assert words in line
    moment = next(q for q in ivsid.export(boat({**TRUTH, **DAMPED}), "gz").text.splitlines() if "<nUV>" in q)
    assert "16.25 to 17.75 kg" in moment


def test_every_target_has_one_file_and_one_name():
    assert [t.name for t in TARGETS] == ["gz", "vrx", "mss", "pvs", "stonefish", "yaml"]


def test_an_identification_is_exported_from_its_folder(tmp_path, twin):
    """Mid-values of its intervals, in the total form and in that of added masses."""
    from conftest import as_log, embedded

    vehicle = parse_vehicle(embedded("swan.toml"), "swan.toml")
    fit = ivsid.identify(vehicle, as_log(twin))
    fit.save(tmp_path / "fit")
    read = read_identification(tmp_path / "fit")
    made = ivsid.export(tmp_path / "fit", "yaml")
    line = next(q for q in made.text.splitlines() if '"mass.surge"' in q)
    assert f"value: {read.parameters['mass.surge'].midpoint!r}" in line
    assert f"lower: {read.parameters['mass.surge'].lower!r}" in line
    assert made == ivsid.export(read, "yaml")
    done = run("export", tmp_path / "fit", "--to", "mss", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    record = json.loads((tmp_path / "out" / "result.json").read_text())
    assert record["command"] == "export" and record["target"] == "mss" and (tmp_path / "out" / record["file"]).exists()
    assert all(s in done.stdout for s in record["unstated"])
    added = ivsid.export(ivsid.identify(vehicle, as_log(twin), form="added"), "mss").text
    one, other = (matlab(t)[0] for t in (ivsid.export(fit, "mss").text, added))
    assert other["Xudot"] == pytest.approx(one["Xudot"], abs=0.5)


def test_a_diagnosis_is_exported_by_its_model(tmp_path):
    vehicle = boat({**TRUTH, **DAMPED})
    (tmp_path / "result.json").write_text('{"command": "diagnose"}')
    with pytest.raises(IvsidError, match="no model.toml"):
        ivsid.export(tmp_path, "gz")
    (tmp_path / "model.toml").write_text(vehicle.text)
    assert ivsid.export(tmp_path, "gz").text.splitlines()[2:] == ivsid.export(vehicle, "gz").text.splitlines()[2:]
    # The command takes the folder and the file, too.
    for given in (tmp_path, tmp_path / "model.toml"):
        done = run("export", given, "--to", "gz", "--out", tmp_path / "out")
        assert done.returncode == 0, done.stderr
    done = run("export", tmp_path / "none", "--to", "gz")
    assert done.returncode == 2


@pytest.mark.parametrize(
    ("given", "to", "words"),
    [
        (lambda _: boat(TRUTH), "gazebo", "'gazebo' is no target; use gz, vrx, mss, pvs, stonefish, yaml"),
        (lambda _: boat({"mass.surge": 58.0}), "gz", "no number for mass.sway, inertia.yaw"),
        (lambda p: p, "gz", "cannot be read"),
        (lambda p: p / "none", "gz", "cannot be read"),
        (lambda p: _written(p, "[1"), "gz", "is no result"),
        (lambda p: _written(p, '{"command": "allan"}'), "gz", "is a result of allan"),
    ],
)
def test_unusable_results_are_refused_in_a_sentence(tmp_path, given, to, words):
    with pytest.raises(IvsidError, match=re.escape(words)):
        ivsid.export(given(tmp_path), to)


def _written(place, text):
    (place / "result.json").write_text(text)
    return place


def test_a_name_is_text_in_every_file():
    """Neither a line break nor a quote of a vehicle's name becomes code or markup."""
    name = """A "boat" & <co> -- one\\nraise SystemExit 'x' """
    text = boat({**TRUTH, **DAMPED}).text.replace('name = "Small boat"', f"name = {json.dumps(name)}", 1)
    vehicle = parse_vehicle(text, "boat.toml")
    assert vehicle.name == name
    for target in ("gz", "vrx", "stonefish"):
        tree = ET.fromstring(ivsid.export(vehicle, target).text)
        assert " ".join(name.split()) in [e.get("name") for e in tree.iter()]
    ship = pvs(ivsid.export(vehicle, "pvs").text, "a_boat_co_one_nraise_systemexit_x")
    assert ship.name == " ".join(name.split())
    with pytest.raises(IvsidError, match="name"):
        parse_vehicle(text.replace('name = "port"', 'name = "port\\"<&>\\n"'), "boat.toml")
    broken = vehicle.model_copy(update={"name": "one\ntwo"})
    for target in TARGETS:
        assert "\ntwo" not in ivsid.export(broken, target.name).text


@pytest.mark.parametrize(
    "name", ["hyphens --- of any ---- number --", "control \x01 \x7f \uffff characters", "class", "End"]
)
def test_every_file_stays_well_formed(name):
    """Names and ids that would end a comment, that no XML takes, or that are words of a language."""
    text = boat({**TRUTH, **DAMPED}).text.replace(
        "[model.fitted]", '[model.values]\n"a\\nraise SystemExit #" = 1\n"b ---> <c" = 2\n[model.fitted]'
    )
    # A file with control characters is refused, a vehicle made in Python is not.
    vehicle = parse_vehicle(text, "boat.toml").model_copy(update={"name": name})
    for target in TARGETS:
        made = ivsid.export(vehicle, target.name)
        assert not any(line.startswith("raise") for line in made.text.splitlines())
        if target.name in ("gz", "vrx", "stonefish"):
            ET.fromstring(made.text)
        if target.name == "pvs":
            ast.parse(made.text)
        if target.name == "mss":
            assert not made.file.startswith(("end.", "class."))
        if target.name == "yaml":
            assert pytest.importorskip("yaml").safe_load(made.text)["name"] == name


def test_added_masses_enclose_the_exact_difference():
    """The part of the rigid body about the origin is a sum of products, whose doubles fall to either side."""
    rng = np.random.default_rng(5)
    for _ in range(50):
        x, y = rng.uniform(-0.4, 0.4, 2).tolist()
        vehicle = boat({**TRUTH, "inertia.yaw": float(rng.uniform(10, 20))})
        hull = vehicle.hull.model_copy(update={"centre_of_gravity": (x, y), "mass": float(rng.uniform(30, 60))})
        model = planar_of(vehicle.model_copy(update={"hull": hull}))
        added, whole = model.added[2].ends, model.yaw.ends
        about = Fraction(model.rigid_inertia) + Fraction(hull.mass) * (Fraction(x) ** 2 + Fraction(y) ** 2)
        assert Fraction(added.lower) <= Fraction(whole.lower) - about
        assert Fraction(whole.upper) - about <= Fraction(added.upper)


def test_intervals_in_words_have_six_digits_and_hold_the_number(tmp_path):
    ends = Interval(37.86310282301845, 39.57612893142058)
    assert Number(38.7, "kg", "m", ends).words == "m, 37.8631 to 39.5762 kg"
    assert Number(38.7, "kg").words == "no interval kg"
