"""The command line: what each command leaves behind, and that bad input gets one sentence, code 2, and no file."""

import csv
import json
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest

from command_line import run, run_process
from conftest import as_log, embedded
from ivsid.identification import METHODS
from ivsid.workflow.log_files import csv as as_csv
from pages import Page, faults


@pytest.fixture(scope="module")
def folder(tmp_path_factory, twin):
    place = tmp_path_factory.mktemp("cli")
    (place / "swan.toml").write_text(embedded("swan.toml"))
    (place / "scenario.toml").write_text(embedded("swan_train.toml").replace("duration = 300.0", "duration = 40.0", 1))
    (place / "log.csv").write_text(as_csv(twin.t, twin.columns))
    return place


@pytest.fixture(scope="module")
def made(folder):
    """``identify`` in a process of its own."""
    done = run_process("identify", folder / "swan.toml", folder / "log.csv", "--out", folder / "fit")
    assert done.returncode == 0, done.stderr
    return done


def test_identify_and_validate_leave_their_files(folder, twin, made):
    assert "guaranteed" in made.stdout and "mass.surge" in made.stdout
    record = json.loads((folder / "fit" / "result.json").read_text())
    assert record["command"] == "identify" and record["status"] == "enclosed" and record["guaranteed"] is True
    truth = twin.truth["parameters"]["mass.surge"]
    mass = record["parameters"]["mass.surge"]
    assert mass["lower"] <= truth <= mass["upper"] and mass["unit"] == "kg" and mass["symbol"] == "m - X_udot"
    assert len(record["inputs"][0]["sha256"]) == 64 and record["vehicle"] == embedded("swan.toml")
    page = (folder / "fit" / "report.html").read_text()
    assert "http://" not in page and "https://" not in page and "data:image/png;base64," in page
    assert faults(page) == [] and "3 parameters are enclosed" in Page(page).text
    assert {"parameters.png", "parameters.svg", "log.png", "log.svg"} <= {p.name for p in (folder / "fit").iterdir()}
    checked = run_process("validate", folder / "fit", folder / "log.csv", "--out", folder / "check", "--json")
    assert checked.returncode == 0, checked.stderr
    printed = json.loads(checked.stdout)
    assert printed == json.loads((folder / "check" / "result.json").read_text())
    assert printed["force"]["surge"]["falsified_samples"] == 0
    page = (folder / "check" / "report.html").read_text()
    assert faults(page) == [] and "The parameters hold on the other log" in Page(page).text


@pytest.mark.usefixtures("made")
def test_the_same_input_gives_the_same_bytes(folder):
    again = run_process("identify", folder / "swan.toml", folder / "log.csv", "--out", folder / "again")
    assert again.returncode == 0, again.stderr
    for path in sorted((folder / "fit").iterdir()):
        assert path.read_bytes() == (folder / "again" / path.name).read_bytes(), path.name


def test_simulate_writes_a_log_and_keeps_the_truth_apart(folder):
    arguments = ("simulate", folder / "swan.toml", folder / "scenario.toml", "--seed", 5)
    made = run(*arguments, "--effect", "drag.surge.linear=4", "--out", folder / "sim")
    assert made.returncode == 0, made.stderr
    truth = json.loads((folder / "sim" / "truth.json").read_text())
    assert truth["parameters"]["drag.surge.linear"] == 4 and truth["seed"] == 5
    with (folder / "sim" / "log.csv").open() as file:
        rows = list(csv.reader(file))
    assert rows[0] == ["t", "u", "v", "r", "ax", "ay", "demand_port", "demand_starboard"] and len(rows) == 801
    assert "4" not in json.loads((folder / "sim" / "result.json").read_text())["log"]["columns"]
    again = run(*arguments, "--effect", "drag.surge.linear=4", "--out", folder / "sim2")
    assert again.returncode == 0
    assert (folder / "sim" / "log.csv").read_bytes() == (folder / "sim2" / "log.csv").read_bytes()


def test_allan_and_thrust_on_small_files(folder):
    rng = np.random.default_rng(0)
    static = {"ax": rng.standard_normal(3000) * 0.01, "r": rng.standard_normal(3000) * 0.002}
    (folder / "static.csv").write_text(as_csv(np.arange(3000) * 0.05, static))
    made = run("allan", folder / "static.csv", "--out", folder / "allan", "--json")
    assert made.returncode == 0, made.stderr
    record = json.loads(made.stdout)
    assert record["channels"]["ax"]["random_walk"] == pytest.approx(0.01 * np.sqrt(0.05), rel=0.1)
    assert "[sensors.acceleration]" in record["toml"] and "[sensors.yaw_rate]" in record["toml"]
    (folder / "table.csv").write_text("PWM (us),Force (Kg f)\n1100,-2\n1300,-1\n1480,0\n1520,0\n1700,1.2\n1900,2.4\n")
    made = run("thrust", folder / "table.csv", "--out", folder / "thrust", "--json")
    assert made.returncode == 0, made.stderr
    record = json.loads(made.stdout)
    assert record["unit"] == "kgf" and record["dead_band"] == [1480, 1520] and "neutral = 1500" in record["toml"]


BAD_LOGS = {
    "empty.csv": b"",
    "row.csv": b"t,u\n0,1\n",
    "binary.csv": np.random.default_rng(0).bytes(3000),
    "backwards.csv": b"t,u,v,r\n0,1,1,1\n1,1,1,1\n0.5,1,1,1\n",
    "missing.csv": b"t,u,v,r\n0,1,1,1\n1,1,1,1\n",
    "words.csv": b"t,u\n0,1\n1,quick\n",
}


@pytest.mark.parametrize("name", BAD_LOGS)
@pytest.mark.parametrize("command", ["identify", "allan"])
def test_bad_logs_get_one_sentence(folder, name, command):
    (folder / name).write_bytes(BAD_LOGS[name])
    arguments = [folder / "swan.toml", folder / name] if command == "identify" else [folder / name]
    refused(run(command, *arguments, "--out", folder / "bad"), folder / "bad")


def test_a_process_refuses_as_this_one_does(folder):
    (folder / "words.csv").write_bytes(BAD_LOGS["words.csv"])
    arguments = ("identify", folder / "swan.toml", folder / "words.csv", "--out", folder / "bad")
    own, here = run_process(*arguments), run(*arguments)
    refused(own, folder / "bad")
    assert (own.returncode, own.stdout, own.stderr) == (here.returncode, here.stdout, here.stderr)


def refused(made, out: Path, *parts: str):
    assert made.returncode == 2, (made.stdout, made.stderr)
    assert "Traceback" not in made.stderr and made.stdout == ""
    assert len(made.stderr.strip().splitlines()) == 1, made.stderr
    assert not out.exists(), "no half-written output"
    for part in parts:
        assert part in made.stderr


def test_other_bad_input(folder, twin):
    out = folder / "refused"
    swan, log = folder / "swan.toml", folder / "log.csv"
    misspelt = folder / "misspelt.toml"
    misspelt.write_text(embedded("swan.toml").replace("mass =", "mas ="))
    refused(run("identify", misspelt, log, "--out", out), out, "hull.mas", "did you mean mass")
    columns = {**twin.columns, "demand_port": twin.columns["demand_port"] + 80}
    (folder / "outside.csv").write_text(as_csv(twin.t, columns))
    refused(run("identify", swan, folder / "outside.csv", "--out", out), out, "outside its table (0 to 85)")
    gone = {**twin.columns, "u": np.where(np.arange(twin.t.size) > 100, np.nan, twin.columns["u"])}
    (folder / "gone.csv").write_text(as_csv(twin.t, gone))
    refused(run("identify", swan, folder / "gone.csv", "--out", out), out, "column u misses", "in a row")
    refused(run("identify", swan, folder / "nothing.csv", "--out", out), out, "cannot be read")
    refused(run("identify", swan, log, "--method", "magic", "--out", out), out, "'magic' is not available")
    refused(run("validate", folder, log, "--out", out), out, "cannot be read")
    refused(
        run("validate", folder / "swan.toml", log, "--out", out),
        out,
        "needs the result of ivsid identify",
        "swan.toml is",
    )
    refused(run("simulate", swan, swan, "--out", out), out, "swan.toml is a vehicle file")
    refused(
        run("simulate", swan, folder / "scenario.toml", "--effect", "drag.magic=1", "--out", out), out, "not simulated"
    )
    refused(run("simulate", swan, folder / "scenario.toml", "--effect", "drag", "--out", out), out, "ID=VALUE")
    refused(run("thrust", log, "--out", out), out, "--thrust-column")
    refused(run("fly"), out, "No such command")
    refused(run("identify", swan), out, "Missing argument", "a log")


def test_an_unwritable_folder_is_refused_before_any_work(folder):
    (folder / "file").write_text("here")
    made = run("identify", folder / "swan.toml", folder / "log.csv", "--out", folder / "file" / "deep")
    assert made.returncode == 2 and "cannot be written" in made.stderr and "Traceback" not in made.stderr
    made = run("identify", folder / "swan.toml", folder / "log.csv", "--out", "/proc/ivsid")
    assert made.returncode == 2 and "cannot be written" in made.stderr and "Traceback" not in made.stderr


def test_json_prints_nothing_else_and_matches_the_file(folder):
    made = run("identify", folder / "swan.toml", folder / "log.csv", "--out", folder / "j", "--json")
    assert made.returncode == 0 and json.loads(made.stdout) == json.loads((folder / "j" / "result.json").read_text())


def test_version_and_help():
    assert run_process("--version").stdout.startswith("ivsid 0.")
    shown = run_process("--help")
    assert shown.returncode == 0
    for name in ("demo", "simulate", "allan", "thrust", "identify", "validate"):
        assert name in shown.stdout


def test_help_names_every_method():
    from ivsid.cli import parameters

    (option,) = get_type_hints(parameters.identify, include_extras=True)["method"].__metadata__
    assert {*option.help.rstrip(".").replace(" or ", ", ").split(", ")} == {*METHODS}


def test_wide_logs_are_listed_in_the_result(folder, twin):
    (folder / "wide.csv").write_text(as_csv(twin.t, {**twin.columns, "temperature": twin.t}))
    made = run("identify", folder / "swan.toml", folder / "wide.csv", "--out", folder / "wide", "--json")
    assert "temperature" in json.loads(made.stdout)["ignored"]


def test_as_log_is_what_the_file_says(folder, twin):
    from ivsid import read_log

    read = read_log(folder / "log.csv")
    for name, column in as_log(twin).columns.items():
        np.testing.assert_array_equal(read.columns[name], column)


def test_more_bad_input(folder):
    out = folder / "refused2"
    swan, log = folder / "swan.toml", folder / "log.csv"
    refused(run("identify", swan, log, "--window", "1e9", "--out", out), out, "longer than log.csv")
    (folder / "twice.csv").write_text("t,u,u\n0,1,2\n1,2,3\n")
    refused(run("identify", swan, folder / "twice.csv", "--out", out), out, "column u more than once")
    (folder / "dead.csv").write_text("demand,thrust\n1,0\n2,0\n3,0\n")
    refused(run("thrust", folder / "dead.csv", "--out", out), out, "no thrust at all")
    scenario = embedded("swan_train.toml").replace('"mass.surge" = 60.45', '"mass.surge" = -5', 1)
    (folder / "negative.toml").write_text(scenario)
    # The mass matrix says it before the motion does.
    refused(run("simulate", swan, folder / "negative.toml", "--out", out), out, "not positive definite")


def test_a_hidden_effect_is_named_in_the_truth_alone(folder):
    drawn, seeds = set(), set()
    for seed in range(6):
        out = folder / f"hidden{seed}"
        made = run("simulate", folder / "swan.toml", folder / "scenario.toml", "--hide", seed, "--out", out)
        assert made.returncode == 0, made.stderr
        # The truth stands in a folder of its own, the seed of the noise in the truth alone.
        told = json.loads((folder / f"hidden{seed}-truth" / "truth.json").read_text())
        drawn |= set(told["effects"]) or {"none"}
        assert not (out / "truth.json").exists() and json.loads((out / "result.json").read_text())["seed"] is None
        for word in (*told["effects"], str(told["seed"])):
            for path in out.iterdir():
                assert word.encode() not in path.read_bytes(), path.name
            assert word not in made.stdout
        seeds.add(told["seed"])
    assert len(drawn) > 2 and len(seeds) == 6
    place = folder / "elsewhere" / "known.json"
    made = run("simulate", folder / "swan.toml", folder / "scenario.toml", "--truth", place, "--out", folder / "plain")
    assert made.returncode == 0 and json.loads(place.read_text())["effects"] == {}
    assert (folder / "plain" / "log.csv").exists() and not (folder / "plain" / "truth.json").exists()
    refused(
        run(
            "simulate",
            folder / "swan.toml",
            folder / "scenario.toml",
            "--hide",
            1,
            "--effect",
            "drag.surge.linear=1",
            "--out",
            folder / "h",
        ),
        folder / "h",
        "leave --effect out",
    )


def test_effects_of_several_numbers_and_their_refusals(folder):
    swan, scenario, out = folder / "swan.toml", folder / "scenario.toml", folder / "current"
    made = run(
        "simulate",
        swan,
        scenario,
        "--effect",
        "current.steady=0.08,0.05",
        "--effect",
        "thruster.lag.port=0.2",
        "--out",
        out,
    )
    assert made.returncode == 0, made.stderr
    truth = json.loads((out / "truth.json").read_text())
    assert truth["effects"] == {"current.steady.north": 0.08, "current.steady.east": 0.05, "thruster.lag.port": 0.2}
    assert truth["parameters"]["thruster.lag.port"] == 0.2
    assert max(truth["integration"]["error"].values()) < 1e-4
    none = folder / "none"
    for effect, sentence in (
        ("current.steady=0.1", "takes 2 numbers"),
        ("wave.force=1,0,0,0", "must be above 0"),
        ("thruster.lag.bow=1", "no thruster bow"),
        ("drag.surge.linear=nan", "is not understood"),
        ("drag.surge.linear=1,2", "takes 1 number (drag.surge.linear [kg/s])"),
        ("drag.surge.linear", "ID=A,B"),
    ):
        refused(run("simulate", swan, scenario, "--effect", effect, "--out", none), none, sentence)


def test_a_shipped_vehicle_by_its_name(tmp_path):
    made = run("simulate", "vectored_rov", "vectored_rov", "--out", tmp_path / "sim")
    assert made.returncode == 0, made.stderr
    truth = json.loads((tmp_path / "sim" / "truth.json").read_text())["parameters"]
    assert truth["mass.surge"] == 19.86 and truth["drag.surge.quadratic"] == 141.0
    refused(
        run("simulate", "canoe", "canoe", "--out", tmp_path / "no"),
        tmp_path / "no",
        "vehicle file canoe cannot be read",
    )


def test_the_bias_of_the_accelerometer_can_be_chosen(folder):
    records = {}
    for choice in ("sample", "log"):
        out = folder / f"bias-{choice}"
        made = run("identify", folder / "swan.toml", folder / "log.csv", "--bias", choice, "--out", out)
        assert made.returncode == 0, made.stderr
        records[choice] = json.loads((out / "result.json").read_text())
        assert records[choice]["options"]["bias"] == choice
    unknown = {c: any("one unknown for the log" in a for a in r["assumes"]) for c, r in records.items()}
    assert unknown == {"sample": False, "log": True}
    assert records["sample"]["parameters"] != records["log"]["parameters"]
    assert run("verify", folder / "bias-log", folder / "log.csv", "--out", folder / "proved").returncode == 0
    refused = run("identify", folder / "swan.toml", folder / "log.csv", "--bias", "never", "--out", folder / "no-bias")
    assert refused.returncode == 2 and "bias 'never' is unknown; use auto, sample, log" in refused.stderr
    assert "Traceback" not in refused.stderr and not (folder / "no-bias").exists()
