"""``ivsid verify``: what it proves, and that it proves nothing else."""

import json
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import ivsid
from conftest import as_log
from edited_results import written
from ivsid import identify, verify
from ivsid.errors import IvsidError
from ivsid.files.records import to_json
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.verification.cells import covers

MODEL = "\n[model]\nterms = ["


def test_what_identify_writes_is_proved(fits):
    files, log, _ = fits
    for name in ("pointwise", "integral", "both", "added"):
        verdict = verify(files[name], log)
        assert verdict.proved and verdict.claim == "enclosed" and verdict.certificates >= 6, (name, verdict.failures)
    verdict = verify(files["empty"], log)
    assert verdict.proved and verdict.claim == "empty", verdict.failures


def test_a_method_without_certificates_is_not_proved(fits):
    files, log, _ = fits
    verdict = verify(files["published"], log)
    assert not verdict.proved and "leaves no certificates" in verdict.failures[0]


def test_damaged_results_are_failures_and_other_files_are_refused(fits, tmp_path):
    files, log, _ = fits
    record = json.loads(files["pointwise"].read_text())
    for key in record:
        edited = {k: v for k, v in record.items() if k != key}
        if key == "command":
            with pytest.raises(IvsidError, match="not the result of ivsid identify"):
                verify(written(tmp_path / "r.json", edited), log)
        else:
            (tmp_path / "r.json").write_text(to_json(edited))
            assert not verify(tmp_path / "r.json", log).proved, key
    with pytest.raises(IvsidError, match="cannot be read"):
        verify(tmp_path / "nowhere", log)
    (tmp_path / "r.json").write_text("{")
    with pytest.raises(IvsidError, match="is not JSON"):
        verify(tmp_path / "r.json", log)


def test_it_runs_without_the_core(fits):
    """In a process where the compiled core cannot be imported at all."""
    files, _, place = fits
    package = Path(ivsid.__file__).parent
    script = f"""
import sys, types
package = types.ModuleType("ivsid"); package.__path__ = [{str(package)!r}]
sys.modules["ivsid"] = package
sys.modules["ivsid._core"] = None
from ivsid.verification import verify
verdict = verify({str(files["pointwise"])!r}, {str(place / "log.csv")!r})
assert verdict.proved, verdict.failures
banned = ["intervals", "linalg", "regression", "rows", "sensors", "thrust", "identification", "effects", "pose"]
assert not [m for m in sys.modules if any(m == f"ivsid.{{b}}" or m.startswith(f"ivsid.{{b}}.") for b in banned)]
"""
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr


def test_cells_cover_every_combination_of_signs_or_not():
    from itertools import product

    rng = np.random.default_rng(3)
    seen = set()
    for _ in range(400):
        n = int(rng.integers(1, 5))
        cells = [tuple(int(x) for x in rng.integers(-1, 2, n)) for _ in range(rng.integers(0, 9))]
        whole = all(
            any(all(c in (0, s) for c, s in zip(cell, signs, strict=True)) for cell in cells)
            for signs in product((1, -1), repeat=n)
        )
        assert covers(cells, n) == whole
        seen.add(whole)
    assert seen == {True, False}
    # Proved signs leave regions out; a branch that nobody looked at does not.
    assert covers([(1, 1)], 2, {(0, 0): ((1, 1), None)})
    assert not covers([(1, 1)], 2, {(0, 0): ((1, 0), 1)})
    assert covers([(1, 1), (1, -1)], 2, {(0, 0): ((1, 0), 1)})
    assert not covers([], 2, {(0, 0): ((1, 1), None)})
    assert not covers([(1, 1)], 2, {(1, 0): ((1, 1), None)})


@pytest.mark.parametrize(
    "change",
    [
        ("azimuth = 0.0", "azimuth = 0.2"),
        ("accuracy = { absolute = 0.5", "time_constant = 0.3\naccuracy = { absolute = 0.5"),
        ("accuracy = { absolute = 0.5", "advance_loss = 0.05\naccuracy = { absolute = 0.5"),
        (
            "accuracy = { absolute = 0.5",
            "dead_band = 16.0\nlimit = 60.1\nreverse_factor = 0.7\naccuracy = { absolute = 0.5",
        ),
        ("accuracy = { absolute = 0.5", 'time_constant = 0.3\nlag = "demand"\naccuracy = { absolute = 0.5'),
    ],
)
# Nightly: pointwise rows, whose thrusts a window takes the means of.
@pytest.mark.parametrize("rows", [pytest.param("pointwise", marks=pytest.mark.nightly), "integral"])
def test_claims_of_thrusters_are_recomputed(swan, programme, tmp_path, change, rows):
    assert change[0] in swan.text
    vehicle = parse_vehicle(swan.text.replace(*change), "claims.toml")
    made = simulate(vehicle, programme.model_copy(update={"noise": "uniform", "duration": 60.0}), 5)
    log = as_log(made)
    fit = identify(vehicle, log, rows=rows)
    fit.save(tmp_path / "r.json")
    verdict = verify(tmp_path / "r.json", log)
    assert verdict.proved, verdict.failures[:3]
    assert fit.status in ("enclosed", "unbounded")


@pytest.mark.slow
def test_every_term_of_the_catalogue_is_recomputed(swan, programme, tmp_path):
    from ivsid.effects import CATALOGUE, terms_of
    from ivsid.verification.physics import CHANNELS, State, model
    from ivsid.verification.rational import Range

    text = swan.text.split("[model]")[0] + f"\n[model]\nterms = {json.dumps(list(CATALOGUE))}\n"
    vehicle = parse_vehicle(text, "all.toml")
    own, terms = model(vehicle, "total"), terms_of(vehicle)
    from ivsid.effects import State as Floats

    rng = np.random.default_rng(0)
    for _ in range(200):
        x = [float(v) for v in rng.normal(size=6)]
        for term in terms:
            theirs = term.columns(Floats(*x))
            mine = own[term.id].columns(State(*(Range(Fraction(v)) for v in x)))
            assert (own[term.id].symbol, own[term.id].unit) == (term.symbol, term.unit)
            for channel in CHANNELS:
                a, b = theirs.get(channel, 0.0), mine.get(channel, Range(0))
                assert float(b.lower) == pytest.approx(a, rel=1e-9, abs=1e-12), (term.id, channel)
    made = simulate(swan, programme.model_copy(update={"noise": "uniform", "duration": 60.0}), 5)
    for id_ in CATALOGUE:
        for rows in ("pointwise", "integral"):
            one = parse_vehicle(swan.text.split("[model]")[0] + f'\n[model]\nterms = ["{id_}"]\n', "one.toml")
            try:
                fit = identify(one, as_log(made), rows=rows)
            except IvsidError:
                continue
            fit.save(tmp_path / "r.json")
            verdict = verify(tmp_path / "r.json", as_log(made))
            assert verdict.proved, (id_, rows, verdict.failures[:3])


def test_the_command_says_it_loudly(fits, tmp_path):
    files, _, place = fits
    command = [sys.executable, "-c", "from ivsid.cli import main; main()", "verify"]

    def run(result):
        return subprocess.run(
            [*command, str(result), str(place / "log.csv"), "--out", str(tmp_path / "v")],
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )

    done = run(files["pointwise"])
    assert done.returncode == 0 and done.stdout.startswith("PROVED"), done.stderr
    assert json.loads((tmp_path / "v" / "result.json").read_text())["status"] == "proved"
    record = json.loads(files["pointwise"].read_text())
    record["parameters"]["mass.surge"]["lower"] += 1.0
    done = run(written(tmp_path / "r.json", record))
    assert done.returncode == 0 and done.stdout.startswith("NOT PROVED"), done.stderr
    assert json.loads((tmp_path / "v" / "result.json").read_text())["status"] == "failed"
    done = run(tmp_path / "nothing.json")
    assert done.returncode == 2 and not done.stdout


def test_the_paper_rule_is_proved_relative_to_it_and_not_called_guaranteed(swan, twin, tmp_path):
    vehicle = parse_vehicle(swan.text.replace("confidence = 0.999", "sigmas = 3"), "three.toml")
    fit = identify(vehicle, as_log(twin))
    fit.save(tmp_path / "r.json")
    assert verify(tmp_path / "r.json", as_log(twin)).proved and not fit.guaranteed
    record = json.loads((tmp_path / "r.json").read_text())
    record["guaranteed"] = True
    verdict = verify(written(tmp_path / "r.json", record), as_log(twin))
    assert not verdict.proved and "under sigmas nothing is guaranteed" in verdict.failures[0]


def test_logged_forces_and_earth_velocities_are_recomputed(swan, twin, tmp_path):
    text = swan.text[: swan.text.index("[[thrusters]]")] + "[sensors" + swan.text.split("[sensors", 1)[1]
    text = (
        text.split("[model]")[0]
        + '\n[sensors.force]\naccuracy = 0.5\n[sensors.moment]\naccuracy = 0.3\n[model]\nterms = "paper"\n'
    )
    vehicle = parse_vehicle(text, "forces.toml")
    log = as_log(twin)
    x = {"force_X": 3.0 + log.columns["u"], "force_Y": 0.1 * log.columns["r"], "moment_N": 2.0 * log.columns["r"]}
    columns = {k: v for k, v in log.columns.items() if not k.startswith("demand")}
    log = replace(log, columns={**columns, **x})
    for rows in ("pointwise", "integral"):
        fit = identify(vehicle, log, rows=rows)
        fit.save(tmp_path / "r.json")
        verdict = verify(tmp_path / "r.json", log)
        assert verdict.proved, verdict.failures[:3]
