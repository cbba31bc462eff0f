"""``ivsid init``: columns, units and signs of a motion in the names of other programs, sensor bounds, marked keys, and its questions."""

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

MOTION = programs.Motion()
# Each writer, the frame of its file, the words of the questions that it must raise, and channels beside u, v, r and the demands.
WRITERS = {
    "ros": (programs.ros, "flu", (), ("psi", "x", "y", "ax", "ay")),
    "foxglove": (programs.foxglove, "flu", (), ()),
    "foxglove_rows": (programs.foxglove_rows, "flu", (), ()),
    "data_base": (programs.data_base, "frd", (), ("psi",)),
    "ardupilot": (programs.ardupilot, "frd", (), ("psi", "x", "y", "roll", "pitch")),
    "mavlink": (programs.mavlink, "frd", (), ("psi", "x", "y", "roll", "pitch")),
    "px4": (programs.px4, "frd", (), ("psi", "x", "y")),
    "mss": (programs.mss, "frd", (), ("psi", "x", "y")),
    "pvs": (programs.pvs, "frd", (), ("psi",)),
    "endings": (programs.endings, "frd", (), ("psi",)),
    "bare": (programs.bare, "frd", (), ("psi", "x", "y")),
    "bare_degrees": (
        programs.bare_degrees,
        "frd",
        ("psi reaches .* read in deg", "r reaches .* read in deg/s"),
        ("psi",),
    ),
    "mirrored": (programs.mirrored, "flu", ("r falls where port pushes more",), ("psi", "x", "y")),
    "topics": (programs.topics, "flu", (), ("psi",)),
    "ros_compass": (
        programs.ros_compass,
        "flu",
        ("heading_deg rises where the yaw rate turns to starboard, so it is read from north to east",),
        ("psi",),
    ),
    "opposed": (
        programs.opposed,
        "frd",
        ("gyro_z falls while heading_deg rises, so it is read with the opposite sign",),
        ("psi",),
    ),
}
TRUE = {
    **{"u": MOTION.u, "v": MOTION.v, "r": MOTION.r, "psi": MOTION.psi, "x": MOTION.north, "y": MOTION.east},
    **{"ax": MOTION.ax, "ay": MOTION.ay, "roll": MOTION.roll, "pitch": MOTION.pitch},
}


def programme() -> str:
    return embedded("example_programme.toml").replace("duration = 180.0", "duration = 90.0")


def filled(text: str) -> str:
    """A proposed file with its marked keys filled in, as a user does it by hand: two screws aft."""
    text = re.sub(r'^mass = "TODO"', "mass = 80.0\nlength = 2.0\ncentre_of_gravity = [0.153125, 0.0]", text, flags=re.M)
    sides = iter(("-0.395", "0.395"))
    text = re.sub(r'^position = "TODO"', lambda _: f"position = [0.0, {next(sides)}]", text, flags=re.M)
    curve = 'quadratic = { forward = 0.01108, reverse = 0.006445 }\ntime_constant = 0.1\nlag = "demand"'
    return re.sub(r'^quadratic = "TODO"', curve, text, flags=re.M)


@pytest.mark.parametrize("name", WRITERS)
def test_a_motion_in_the_names_of_a_program_is_read_as_it_was(tmp_path, name):
    write, frame, questions, further = WRITERS[name]
    path = write(MOTION, tmp_path)
    if name == "ardupilot":
        pytest.importorskip("pymavlink")
    out = tmp_path / "boat.toml"
    made = init([path], out)
    # The file is read back from its text, by the readers that identify and diagnose use.
    vehicle = parse_vehicle(filled(out.read_text()), "boat.toml")
    log = read_log(path, vehicle.log)
    assert vehicle.log.frame == frame and made.record["frame"] == frame
    np.testing.assert_allclose(log.t - log.t[0], MOTION.t, atol=2e-6)
    for channel in ("u", "v", "r", *further):
        error = log.columns[channel] - TRUE[channel]
        error = np.angle(np.exp(1j * error)) if channel == "psi" else error
        # A slower table stands between its own rows under the proposed rates; but for the last row, after its end.
        own = error[:: 2 if name == "px4" and channel != "r" else 1]
        assert np.isfinite(error[:-1]).all() and np.nanmax(np.abs(own)) < 1e-5, channel
    pushed = [t.name for t in vehicle.thrusters]
    assert len(pushed) == 2
    for side, thruster in zip((MOTION.port, MOTION.starboard), vehicle.thrusters, strict=True):
        demand = log.columns[f"demand_{thruster.name}"]
        expected = (side - 1500) / 400 if name == "px4" else side
        assert np.nanmax(np.abs(demand - expected)) < 1e-9
        # Shares of a controller and speeds in rad/s rest at zero, pulses at 1500.
        assert thruster.neutral == (0.0 if name in ("px4", "pvs") else 1500.0)
    raised = made.record["questions"]
    assert len(raised) == len(questions)
    assert all(re.search(q, r) for q, r in zip(questions, raised, strict=True)), raised


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_sway_takes_the_sign_of_a_turned_yaw_rate_where_the_vessel_drifts_outward(tmp_path, sign):
    """Plain names beside a compass: forward, port and up, or a gyro alone upside down."""
    v = -0.3 * MOTION.r
    ay = np.gradient(v, MOTION.t) + MOTION.u * MOTION.r
    table = {"t": MOTION.t, "u": MOTION.u, "v": sign * v, "r": -MOTION.r, "ax": MOTION.ax, "ay": sign * ay}
    table |= {
        "heading_deg": np.degrees(MOTION.psi) % 360,
        "demand_port": MOTION.port,
        "demand_starboard": MOTION.starboard,
    }
    pl.DataFrame(table).write_csv(tmp_path / "log.csv")
    raised = init([tmp_path / "log.csv"], tmp_path / "boat.toml").record["questions"]
    vehicle = parse_vehicle(filled((tmp_path / "boat.toml").read_text()), "boat.toml")
    log = read_log(tmp_path / "log.csv", vehicle.log)
    assert vehicle.log.frame == "frd"
    for name, true in (("v", v), ("r", MOTION.r), ("ay", ay)):
        np.testing.assert_allclose(log.columns[name], true, atol=1e-9)
    assert not any("does the sway velocity need" in q for q in raised)
    assert sum("with the opposite sign alone" in q for q in raised) == (2 if sign < 0 else 0)


def test_a_smooth_heading_keeps_the_constant_error_of_a_good_compass(tmp_path):
    """The attitude of a filter has no scatter, and was proposed with an accuracy of 0.008 degrees."""
    made = init([programs.topics(MOTION, tmp_path)], tmp_path / "boat.toml")
    sensors = parse_vehicle(filled((tmp_path / "boat.toml").read_text()), "boat.toml").sensors
    assert sensors.heading.accuracy == 0.009 and sensors.attitude.accuracy >= 0.0045
    assert (
        "the constant error of a good sensor" in (tmp_path / "boat.toml").read_text() and made.record["questions"] == []
    )


def test_an_accelerometer_that_feels_gravity_is_declared_so(tmp_path):
    for write in (programs.mavlink, programs.ros):
        path = write(MOTION, tmp_path)
        out = tmp_path / f"{write.__name__}.toml"
        init([path], out)
        vehicle = parse_vehicle(filled(out.read_text()), "boat.toml")
        assert vehicle.sensors.acceleration.gravity is True and vehicle.sensors.attitude is not None
        felt = read_log(path, vehicle.log).columns
        x, y = MOTION.felt if write is programs.mavlink else (MOTION.ax, MOTION.ay)
        assert np.abs(felt["ax"] - x).max() < 1e-9 and np.abs(felt["ay"] - y).max() < 1e-9


def test_readings_of_gravity_without_attitude_are_left_out_with_a_word(tmp_path):
    path = tmp_path / "log.csv"
    pl.DataFrame(
        {
            "t": MOTION.t,
            "u": MOTION.u,
            "v": MOTION.v,
            "IMU.GyrZ": MOTION.r,
            "IMU.AccX": MOTION.ax,
            "IMU.AccY": MOTION.ay,
        }
    ).write_csv(path)
    found = propose([path])
    assert "ax" not in found.channels and "ay" not in found.channels
    assert any("IMU.AccX holds gravity" in q for q in found.questions)


def test_a_gyro_in_degrees_is_known_by_the_compass_beside_it(tmp_path):
    """The largest reading, 2 deg/s, would be a possible yaw rate in rad/s."""
    path = programs.bare_slow_degrees(MOTION, tmp_path)
    found = propose([path])
    assert np.abs(found.logs[0].columns["r"] - MOTION.r / 10).max() < 1e-12
    assert any("psi changes as if r were in deg/s" in q for q in found.questions)
    np.testing.assert_array_equal(found.logs[0].columns["psi"], MOTION.psi)


def test_a_heading_that_counts_turns_is_no_heading_in_degrees(tmp_path):
    turns = MOTION.psi - MOTION.psi[0] + 3.0 + 0.2 * MOTION.t
    for factor, unit in ((1.0, "rad"), (180 / np.pi, "deg")):
        path = tmp_path / f"{unit}.csv"
        north = np.cumsum(np.cos(turns)) * 0.05
        east = np.cumsum(np.sin(turns)) * 0.05
        zero = 0 * turns
        pl.DataFrame(
            {"t": MOTION.t, "u": zero + 1, "v": zero, "r": zero + 0.1, "psi": factor * turns, "x": north, "y": east}
        ).write_csv(path)
        found = propose([path])
        assert np.abs(found.logs[0].columns["psi"] - turns).max() < 1e-9
        assert any(f"read in {unit}" in q for q in found.questions)


def test_the_best_column_is_taken_and_the_others_are_named(tmp_path):
    text = propose_text(programs.ros(MOTION, tmp_path), tmp_path)
    (line,) = [x for x in text.splitlines() if x.startswith("r = ")]
    assert '"/imu/data.angular_velocity.z"' in line and "also odom.twist.twist.angular.z" in line


def propose_text(path, folder):
    init([path], folder / "text.toml")
    return (folder / "text.toml").read_text()


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
