"""``ivsid init``: sensor bounds, limits, marked keys, and its questions."""

import io
import json
import re
import sys
import tomllib
from dataclasses import replace
from unittest import mock

import numpy as np
import polars as pl
import pytest

import program_logs as programs
from command_line import run
from conftest import embedded
from ivsid import IvsidError, identify
from ivsid.effects import terms_of
from ivsid.log import read_log
from ivsid.programme.scenario import parse_scenario
from ivsid.proposal import propose
from ivsid.proposal.blanks import Demand
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle, read_vehicle
from ivsid.workflow import init
from ivsid.workflow.log_files import csv
from program_logs import MOTION, filled


def programme() -> str:
    return embedded("example_programme.toml").replace("duration = 180.0", "duration = 90.0")


def test_noise_of_a_still_stretch_comes_from_its_allan_deviation(tmp_path):
    """White noise of known size on a gyro and an accelerometer: five minutes on deck, then a run."""
    rng = np.random.default_rng(4)
    rate, still, moving = 20.0, 6000, 2000
    t = np.arange(still + moving) / rate
    on = np.arange(t.size) >= still
    u = np.where(on, 1.0 + 0.3 * np.sin(0.2 * t), 0.0) + rng.normal(0, 0.002, t.size)
    r = np.where(on, 0.3 * np.sin(0.4 * t), 0.0) + rng.normal(0, 2e-3, t.size)
    columns = {
        **{"t": t, "u": u, "v": rng.normal(0, 0.002, t.size), "r": r},
        **{"ax": rng.normal(0, 0.01, t.size), "ay": rng.normal(0, 0.01, t.size)},
        **{"demand_port": np.where(on, 40.0 + 10 * np.sign(np.sin(t)), 0.0)},
    }
    path = tmp_path / "run.csv"
    pl.DataFrame(columns).write_csv(path)
    found = propose([path])
    assert found.still is not None and found.still.first <= 1.0 and 295 <= found.still.last <= 301
    gyro = {n.key: n for n in found.sensors["yaw_rate"]}
    acceleration = {n.key: n for n in found.sensors["acceleration"]}
    assert 0.8 < gyro["random_walk"].value / (2e-3 / np.sqrt(rate)) < 1.3
    assert 0.8 < acceleration["random_walk"].value / (0.01 / np.sqrt(rate)) < 1.3
    assert "at rest" in gyro["random_walk"].reason
    # Without the stretch at rest the numbers are guesses, and said to be.
    pl.DataFrame({n: c[still:] for n, c in columns.items()}).write_csv(path)
    guessed = propose([path])
    assert guessed.still is None and all("a guess" in n.reason for n in guessed.sensors["yaw_rate"])
    assert 0.8 < guessed.sensors["yaw_rate"][0].value / (2e-3 / np.sqrt(rate)) < 1.4


def test_a_static_log_beside_the_first_one_gives_the_noise(tmp_path):
    rng = np.random.default_rng(5)
    t = np.arange(4000) / 20
    pl.DataFrame({"t": t, "u": 1 + 0.2 * np.sin(t), "v": 0 * t, "r": 0.2 * np.sin(t)}).write_csv(tmp_path / "run.csv")
    noise = {n: rng.normal(0, s, t.size) for n, s in (("u", 1e-3), ("v", 1e-3), ("r", 1e-3))}
    pl.DataFrame({"t": t, **noise}).write_csv(tmp_path / "deck.csv")
    found = propose([tmp_path / "run.csv", tmp_path / "deck.csv"])
    assert found.still is not None and found.still.log == 1
    assert "deck.csv at rest" in found.sensors["yaw_rate"][0].reason


def test_limits_and_ranges_are_those_of_all_logs(tmp_path):
    t = np.arange(1200) / 20
    for name, peak, demand in (("slow", 0.5, 30.0), ("fast", 1.5, 90.0)):
        pl.DataFrame(
            {
                **{"t": t, "u": peak * np.sin(0.5 * t), "v": 0 * t, "r": 0.1 * peak * np.sin(0.5 * t)},
                "demand_screw": demand * np.sign(np.sin(0.5 * t)),
            }
        ).write_csv(tmp_path / f"{name}.csv")
    found = propose([tmp_path / "slow.csv", tmp_path / "fast.csv"])
    assert found.demands[0].span == 90.0
    limits = {n.key: n.value for n in found.sensors["limits"]}
    # The largest acceleration is 0.75, and of the yaw rate 0.075; half more is proposed, rounded up to two digits.
    assert 1.05 < limits["acceleration"] <= 1.2 and 0.105 < limits["yaw_acceleration"] <= 0.12


@pytest.fixture(scope="module")
def otter(tmp_path_factory):
    """A minute and a half of the shipped Otter, and its true motion."""
    made = simulate(read_vehicle("otter"), parse_scenario(programme(), "programme"), 3, thrusters=1)
    path = tmp_path_factory.mktemp("otter") / "run.csv"
    path.write_text(csv(made.t, made.columns))
    return path, made.exact


@pytest.fixture
def otter_log(otter):
    return otter[0]


def test_a_proposed_file_is_refused_until_its_marked_keys_are_filled_and_read_then(tmp_path, otter):
    otter_log, exact = otter
    out = tmp_path / "boat.toml"
    made = run("init", otter_log, "--out", out, "--yes")
    assert made.returncode == 0, made.stderr
    assert "to fill in: hull.mass, thrusters.port.position, thrusters.port.quadratic" in made.stdout
    assert tomllib.loads(out.read_text())["hull"]["mass"] == "TODO"
    for command in (("identify", out, otter_log), ("diagnose", out, otter_log, otter_log)):
        refused = run(*command, "--out", tmp_path / "no")
        assert refused.returncode == 2 and not (tmp_path / "no").exists()
        assert refused.stderr.startswith(
            f"ivsid: {out}: hull.mass is still TODO; write its value (and of thrusters.port.position, "
        )
        assert refused.stderr.count("\n") == 1
    out.write_text(filled(out.read_text()))
    vehicle = read_vehicle(out)
    log = read_log(otter_log, vehicle.log)
    # The bounds that were guessed from the scatter hold the true motion, which the simulator knows.
    bounded = bound_log(log, vehicle).channels
    for name in ("u", "v", "r", "ax", "ay", "psi"):
        assert (bounded[name].lower <= exact[name]).all() and (exact[name] <= bounded[name].upper).all(), name
        assert np.median(bounded[name].upper - bounded[name].lower) < 0.2 * np.ptp(exact[name]), name


def test_nothing_is_called_guaranteed_while_the_file_holds_guesses(tmp_path, otter_log):
    """With every mark filled in, too; the comment says what to write once the bounds are known."""
    out = tmp_path / "boat.toml"
    init([otter_log], out)
    guessed = filled(out.read_text())
    fit = identify(parse_vehicle(guessed, "boat.toml"), otter_log)
    assert fit.status in ("enclosed", "unbounded", "empty") and not fit.guaranteed
    assert "accuracy = { relative = 0.2 }" in guessed and "not a bound for a log" in fit.assumes[0]
    (line,) = re.findall(r"^sigmas = .*$", guessed, flags=re.M)
    (stated,) = re.findall(
        r"once you know all bounds, .* write in its place: (confidence = [0-9.]+)$", guessed, flags=re.M
    )
    assert identify(parse_vehicle(guessed.replace(line, stated), "boat.toml"), otter_log).guaranteed


@pytest.mark.nightly
def test_a_proposed_file_identifies_and_its_intervals_hold_the_truth(tmp_path, otter_log):
    out = tmp_path / "boat.toml"
    init([otter_log], out)
    # The structure of the model is the user's own knowledge, too.
    model = "".join(read_vehicle("otter").text.partition("[model]")[1:])
    out.write_text(re.sub(r"^\[model\].*?^\]$", "", filled(out.read_text()), flags=re.M | re.S) + model)
    fit = run("identify", out, otter_log, "--out", tmp_path / "fit", "--json")
    assert fit.returncode == 0, fit.stderr
    record = json.loads(fit.stdout)
    # A thrust that is known to a fifth leaves some directions open; whatever is bounded holds the truth.
    assert record["status"] in ("enclosed", "unbounded")
    truth = parse_scenario(programme(), "programme").truth
    closed = 0
    for id_, value in truth.items():
        ends = record["parameters"][id_]
        assert ends["lower"] is None or ends["lower"] <= value, id_
        assert ends["upper"] is None or value <= ends["upper"], id_
        closed += ends["lower"] is not None and ends["upper"] is not None
    assert closed >= 5


def test_the_model_of_a_proposed_file_is_that_of_a_usual_hull_and_a_livelier_log_is_not_refused(tmp_path, otter_log):
    out = tmp_path / "boat.toml"
    init([otter_log], out)
    vehicle = parse_vehicle(filled(out.read_text()), "boat.toml")
    ids = {t.id for t in terms_of(vehicle)}
    assert {f"drag.{axis}.{power}" for axis in ("surge", "sway", "yaw") for power in ("linear", "quadratic")} < ids
    assert {"mass.surge", "mass.sway", "inertia.yaw", "added_mass.munk"} < ids
    # With a length, the cross-flow of its comment is read, too.
    crossed = (
        out.read_text().replace('"drag.sway.quadratic"', '"drag.cross_flow"', 2).replace(', "drag.yaw.quadratic"', "")
    )
    assert "drag.cross_flow" in {t.id for t in terms_of(parse_vehicle(filled(crossed), "boat.toml"))}
    log = read_log(otter_log, vehicle.log)

    def rows(factor):
        columns = {n: factor * x if n.startswith("demand_") else x for n, x in log.columns.items()}
        return build_rows(bound_log(replace(log, columns=columns), vehicle), vehicle, terms_of(vehicle))

    rows(1.45)
    with pytest.raises(IvsidError, match="outside"):
        rows(1.6)
    # Pulses go from 1000 to 2000, shares to the whole.
    assert Demand("a", "a", 1300.0, 1600.0, 1500.0, "").end == 500.0 and Demand("a", "a", 0.0, 0.4, 0.0, "").end == 1.0


def test_one_mark_left_is_named_alone():
    text = 'name = "boat"\n[hull]\nmass = 50\n[[thrusters]]\nname = "bow"\nposition = "TODO"\ngain = 1.0\n'
    with pytest.raises(IvsidError) as refused:
        parse_vehicle(text, "boat.toml")
    assert str(refused.value) == (
        "boat.toml: thrusters.bow.position is still TODO; write its value in place of the mark, the comment beside it says which"
    )


def test_answers_on_a_terminal_leave_no_mark(tmp_path, otter_log):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    out = tmp_path / "boat.toml"
    answers = "heavy\n80\n0, -0.395\n134\n0, 0.395\n\n"
    with mock.patch.object(sys, "stdin", Terminal(answers)):
        made = run("init", otter_log, "--out", out)
    assert made.returncode == 0, made.stderr
    assert "heavy is not understood; write a positive number" in made.stdout
    table = tomllib.loads(out.read_text())
    port, starboard = table["thrusters"]
    assert table["hull"]["mass"] == 80 and port["position"] == [0.0, -0.395] and starboard["position"] == [0.0, 0.395]
    # A pull of 134 N at the largest demand, of which the range is half more.
    largest = port["demand_range"][1] / 1.5
    assert port["quadratic"]["forward"] * largest**2 == pytest.approx(134, rel=1e-3)
    # An empty answer leaves the question to the file.
    assert starboard["quadratic"] == "TODO" and "to fill in: thrusters.starboard.quadratic" in made.stdout


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        (
            {"a": [1.0, 2.0], "b": [1.0, 3.0]},
            "has no column whose name is known; it has a, b: name its velocities u, v, r",
        ),
        (
            {"t": [0.0, 0.0, 1.0, 1.0], "topic": ["/a", "/b"] * 2, "value": [1.0, 2.0, 3.0, 4.0]},
            "has no column whose name is known; it has t, /a, /b: name its velocities u, v, r",
        ),
        ({"u": [1.0, 2.0], "v": [1.0, 3.0]}, "has no column of stamps whose name is known beside u; name it t"),
    ],
)
def test_a_log_without_known_names_is_refused_in_one_sentence(tmp_path, columns, words):
    path = tmp_path / "log.csv"
    pl.DataFrame(columns).write_csv(path)
    made = run("init", path, "--out", tmp_path / "boat.toml", "--yes")
    assert made.returncode == 2 and words in made.stderr and made.stderr.count("\n") == 1
    assert not (tmp_path / "boat.toml").exists()


def test_no_file_is_overwritten_and_another_log_has_the_same_columns(tmp_path, otter_log):
    out = tmp_path / "boat.toml"
    out.write_text("mine")
    made = run("init", otter_log, "--out", out, "--yes")
    assert (
        made.returncode == 2
        and "exists, and ivsid init overwrites no file" in made.stderr
        and out.read_text() == "mine"
    )
    other = programs.mavlink(MOTION, tmp_path)
    made = run("init", otter_log, other, "--out", tmp_path / "new.toml", "--yes")
    assert made.returncode == 2 and "has none of the columns u, v, r" in made.stderr


def test_what_the_log_lacks_is_a_question(tmp_path):
    path = tmp_path / "log.csv"
    pl.DataFrame({"t": MOTION.t, "r": MOTION.r, "rudder_angle": MOTION.r}).write_csv(path)
    asked = propose([path]).questions
    assert any(q.startswith("no column is known for u, v") for q in asked)
    assert any(q.startswith("no column is known for the thrusters' demands") for q in asked)
    assert any("rudder_angle may be the angle of a rudder" in q for q in asked)


def test_a_frame_that_nothing_tells_is_a_question(tmp_path):
    path = tmp_path / "log.csv"
    columns = {"t": MOTION.t, "u": MOTION.u, "v": MOTION.v, "r": MOTION.r, "demand_a": MOTION.port}
    pl.DataFrame({**columns, "demand_b": MOTION.starboard}).write_csv(path)
    found = propose([path])
    assert found.mapped.frame == "frd" and any(
        "do not say whether sway and yaw are positive" in q for q in found.questions
    )


def test_empty_columns_and_words_give_way_to_the_next_column(tmp_path):
    """The first gyro is there without a sample, and a mode is written in words."""
    path = tmp_path / "log.csv"
    pl.DataFrame(
        {
            **{
                "t": MOTION.t,
                "IMU[0].GyrZ": [None] * MOTION.t.size,
                "IMU[1].GyrZ": MOTION.r,
                "u": MOTION.u,
                "v": MOTION.v,
            },
            **{"demand_port": MOTION.port, "thruster_command": ["hold"] * MOTION.t.size},
        },
        schema_overrides={"IMU[0].GyrZ": pl.Float64},
    ).write_csv(path)
    found = propose([path])
    assert found.channels["r"].match.column == "IMU[1].GyrZ"
    np.testing.assert_array_equal(found.logs[0].columns["r"], MOTION.r)
    assert [d.name for d in found.demands] == ["port"]
