"""``ivsid init`` on headers with units: those that are known, and those that nobody knows, which it asks for."""

import math
import tomllib

import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.cli import questions
from ivsid.files import units
from ivsid.log import read_log
from ivsid.log.headers import spelled
from ivsid.proposal import Answers, propose, vehicle_file
from ivsid.vehicle import parse_vehicle
from ivsid.workflow import init

T = 0.1 * np.arange(60)
TRUE = {"u": np.sin(T), "v": 0.1 * np.cos(T), "r": 0.2 * np.sin(2 * T), "psi": 0.1 * (1 - np.cos(2 * T))}


def written(path, headers, factors=(1, 1, 1, 1)):
    """A log whose cells are those of the truth over a factor each."""
    cells = [T, *(x / f for x, f in zip(TRUE.values(), factors, strict=True)), 50 + 40 * np.sin(T), 50 - 40 * np.sin(T)]
    head = ",".join(["t [s]", *headers, "demand_port [%]", "demand_starboard [click]"])
    path.write_text(head + "\n" + "".join(",".join(f"{x:.9f}" for x in row) + "\n" for row in zip(*cells, strict=True)))
    return path


@pytest.mark.parametrize(
    ("headers", "factors"),
    [
        (("u [cm/s]", "v [ft/s]", "r [mrad/s]", "psi [gon]"), (0.01, 0.3048, 1e-3, math.pi / 200)),
        (("u [mph]", "v [m/min]", "r [deg/min]", "psi [grad]"), (0.44704, 1 / 60, math.pi / 10800, math.pi / 200)),
        (("u_cm_s", "v_mph", "r_mrad_s", "psi_deg"), (0.01, 0.44704, 1e-3, math.pi / 180)),
    ],
)
def test_units_of_headers_and_endings_are_read(tmp_path, headers, factors):
    path = written(tmp_path / "log.csv", headers, factors)
    log = read_log(path, propose([path]).mapped.checked)
    for name, x in TRUE.items():
        np.testing.assert_allclose(log.columns[name], x, atol=1e-6)
    assert {c for c in log.columns if c.startswith("demand_")} == {"demand_port", "demand_starboard"}
    assert log.columns["demand_port"].max() == pytest.approx(90.0, abs=0.5)


def test_milli_g_are_not_g():
    assert spelled("mG") == "mg" and units.COLUMN["mg"] == pytest.approx(units.COLUMN["g"] / 1000)


def test_an_unknown_unit_is_asked_for_and_its_scale_is_left_to_the_file(tmp_path):
    path = written(tmp_path / "log.csv", ("u [m/s]", "v [m/s]", "r [rad/s]", "psi [smoot]"), (1, 1, 1, 1.7))
    found = propose([path])
    assert list(found.unread) == ["psi"] and "log.columns.psi.scale" in found.blanks(Answers())
    assert any("psi [smoot] states the unit 'smoot', which is not known: how many rad" in q for q in found.questions)
    lines = init([path], tmp_path / "boat.toml").lines
    assert any(q.startswith("  question: the header psi [smoot]") for q in lines)
    text = (tmp_path / "boat.toml").read_text()
    assert tomllib.loads(text)["log"]["columns"]["psi"] == {"from": "psi [smoot]", "scale": "TODO"}
    with pytest.raises(IvsidError, match=r"still TODO"):
        parse_vehicle(text, "boat.toml")


@pytest.mark.parametrize("scale", [1.7, 1.0])
def test_the_scale_that_the_user_knows_is_taken(tmp_path, monkeypatch, scale):
    path = written(tmp_path / "log.csv", ("u [m/s]", "v [m/s]", "r [rad/s]", "psi [smoot]"), (1, 1, 1, scale))
    said = iter([str(scale), *[""] * 9])
    monkeypatch.setattr(questions.typer, "prompt", lambda *_, **__: next(said))
    init([path], tmp_path / "boat.toml", ask=questions.answers)
    text = (tmp_path / "boat.toml").read_text()
    assert tomllib.loads(text)["log"]["columns"]["psi"] == {"from": "psi [smoot]", "scale": scale}
    found = propose([path], {"psi": scale})
    assert not found.unread and "smoot" not in " ".join(found.questions)
    np.testing.assert_allclose(read_log(path, found.mapped.checked).columns["psi"], TRUE["psi"], atol=1e-6)
    assert vehicle_file(found, Answers(), "boat").count("TODO") >= 2


def test_a_header_with_a_unit_names_no_further_thruster(tmp_path):
    """``demand_port [%]`` was a thruster called "port [%]" beside the one that the file maps."""
    path = written(tmp_path / "log.csv", ("u", "v", "r", "psi"))
    log = read_log(path, propose([path]).mapped.checked)
    assert not [c for c in log.columns if "[" in c]
