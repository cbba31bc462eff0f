"""``ivsid verify``: what it proves, and that it proves nothing else."""

import copy
import json
import math
import subprocess
import sys
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import ivsid
from conftest import as_log
from ivsid import identify, verify
from ivsid.errors import IvsidError
from ivsid.intervals import outward_decimal
from ivsid.log import read_log
from ivsid.records import Lower, Upper, sealed, to_json
from ivsid.seal import seal_of
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.verification.cells import covers
from ivsid.workflow.common import csv as as_csv

MODEL = "\n[model]\nterms = ["


def outward(p):
    """Ends with decimals on their outer side, as ``identify`` prints them."""
    kinds = {"lower": Lower, "upper": Upper}
    return {k: kinds[k](v) if k in kinds and isinstance(v, float) else v for k, v in p.items()}


def written(place: Path, record) -> Path:
    """The record with the seal of its content: an edit on purpose."""
    content = {k: v for k, v in record.items() if k != "seal"}
    if isinstance(content.get("parameters"), dict):
        content["parameters"] = {k: outward(p) for k, p in content["parameters"].items()}
    place.write_text(to_json(sealed(content)))
    return place


def resealed(text: str) -> str:
    """A result's text with the seal of what it says now."""
    return text.replace(json.loads(text)["seal"], seal_of(text))


@pytest.fixture(scope="module")
def fits(tmp_path_factory, swan, twin):
    """Results of several kinds beside their logs: name -> (result.json, log)."""
    place = tmp_path_factory.mktemp("verify")
    path = place / "log.csv"
    path.write_text(as_csv(twin.t, twin.columns))
    log = read_log(path, swan.log)
    wrong = parse_vehicle(
        swan.text.split("[model]")[0] + '[model]\nterms = ["mass.surge", "drag.surge.linear"]\n', "wrong.toml"
    )
    made = {
        "pointwise": identify(swan, log),
        "integral": identify(swan, log, rows="integral", window=1.0),
        "both": identify(swan, log, rows="both"),
        "added": identify(swan, log, form="added"),
        "empty": identify(wrong, log),
        "published": identify(swan, log, "published"),
    }
    files = {}
    for name, fit in made.items():
        fit.save(place / f"{name}.json")
        files[name] = place / f"{name}.json"
    return files, log, place


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


def exact_end(record, certificate) -> Fraction:
    """The end that a certificate's basis gives, by its vertex: the independent way, through the unknowns themselves."""
    ids, signs = list(certificate["orthant"]), list(certificate["orthant"].values())
    equations = []
    for row in certificate["rows"]:
        low, high = ([Fraction(float.fromhex(x)) for x in row[k]] for k in ("lower", "upper"))
        right = [Fraction(float.fromhex(x)) for x in row["right"]]
        first = row["side"] == "upper"
        pick = [
            (a if (s or 1) > 0 else b) if first else (b if (s or 1) > 0 else a)
            for a, b, s in zip(low, high, signs, strict=True)
        ]
        equations.append([*pick, right[1] if first else right[0]])
    for s in certificate["signs"]:
        equations.append([*(Fraction(i == s["parameter"]) for i in ids), Fraction(0)])
    n = len(ids)
    for k in range(n):
        pivot = next(i for i in range(k, len(equations)) if equations[i][k])
        equations[k], equations[pivot] = equations[pivot], equations[k]
        equations[k] = [x / equations[k][k] for x in equations[k]]
        for i in range(len(equations)):
            if i != k:
                equations[i] = [a - equations[i][k] * b for a, b in zip(equations[i], equations[k], strict=True)]
    return equations[ids.index(certificate["parameter"])][n]


def tightened(bound: Fraction, end: str) -> float:
    """The first double beyond what is proved."""
    x = float(bound)
    step = math.inf if end == "lower" else -math.inf
    while (Fraction(x) <= bound) if end == "lower" else (Fraction(x) >= bound):
        x = math.nextafter(x, step)
    return x


@pytest.mark.parametrize("name", ["pointwise", "integral"])
def test_one_ulp_beyond_the_proof_is_refused(fits, tmp_path, name):
    files, log, _ = fits
    record = json.loads(files[name].read_text())
    for number, certificate in enumerate(record["certificates"]):
        if certificate["proves"] != "bound" or not math.isfinite(float.fromhex(certificate["bound"])):
            continue
        beyond = tightened(exact_end(record, certificate), certificate["end"])
        edited = copy.deepcopy(record)
        edited["certificates"][number]["bound"] = beyond.hex()
        verdict = verify(written(tmp_path / "r.json", edited), log)
        assert not verdict.proved and any(f"certificate {number}" in f for f in verdict.failures)
        # The last double that the multipliers prove is one step back, and it is accepted.
        edited["certificates"][number]["bound"] = math.nextafter(
            beyond, -math.inf if certificate["end"] == "lower" else math.inf
        ).hex()
        assert verify(written(tmp_path / "r.json", edited), log).proved


def test_a_printed_end_beyond_its_certificates_is_refused(fits, tmp_path):
    files, log, _ = fits
    record = json.loads(files["pointwise"].read_text())
    for id_, p in record["parameters"].items():
        for end, step in (("lower", math.inf), ("upper", -math.inf)):
            edited = copy.deepcopy(record)
            edited["parameters"][id_][end] = math.nextafter(p[end], step)
            verdict = verify(written(tmp_path / "r.json", edited), log)
            assert not verdict.proved and f"the {end} end of {id_}" in verdict.failures[0]
            edited["parameters"][id_][end] = math.nextafter(p[end], -step)
            assert verify(written(tmp_path / "r.json", edited), log).proved
            # A decimal beyond the double that it reads back as, by less than doubles can tell.
            text = written(tmp_path / "r.json", record).read_text()
            exact = Fraction(p[end]) + Fraction(int(math.copysign(1, step)), 10**28)
            digits = f"{exact.numerator * 10**30 // exact.denominator}"
            decimal = f"{digits[:-30] or 0}.{digits[-30:].zfill(30)}"
            assert float(decimal) == p[end]
            shown = f'"{end}": {outward_decimal(p[end], up=end == "upper")}'
            assert shown in text
            (tmp_path / "s.json").write_text(resealed(text.replace(shown, f'"{end}": {decimal}', 1)))
            assert not verify(tmp_path / "s.json", log).proved


def test_a_changed_log_is_refused(fits, tmp_path):
    files, _, place = fits
    record = json.loads(files["pointwise"].read_text())
    lines = (place / "log.csv").read_text().splitlines()
    used = next(c for c in record["certificates"] if c["proves"] == "bound")["rows"][0]
    k = next(i for i, line in enumerate(lines[1:], 1) if float(line.split(",")[0]) == used["time"])
    column = lines[0].split(",").index("u")
    cells = lines[k].split(",")
    cells[column] = repr(float(cells[column]) + 0.01)
    lines[k] = ",".join(cells)
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n")
    changed = read_log(tmp_path / "log.csv")
    verdict = verify(files["pointwise"], changed)
    assert not verdict.proved and any("SHA-256" in f for f in verdict.failures)
    record["inputs"][1]["sha256"] = changed.sha256
    verdict = verify(written(tmp_path / "r.json", record), changed)
    assert not verdict.proved and any("recomputed as" in f for f in verdict.failures)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("accuracy = 0.002", "accuracy = 0.0021"),
        ("confidence = 0.999", "confidence = 0.9999"),
        ("absolute = 0.5", "absolute = 0.50001"),
        ("random_walk = [0.0018", "random_walk = [0.0019"),
        ("azimuth = 0.0", "azimuth = 0.1"),
        ("mass = 52.45", "mass = 62.45"),
    ],
)
def test_a_changed_vehicle_is_refused(fits, tmp_path, old, new):
    """Wider sensor bounds, a better confidence, another curve: the stored rows no longer hold what follows."""
    import hashlib

    files, log, _ = fits
    record = json.loads(files["both"].read_text())
    assert old in record["vehicle"]
    record["vehicle"] = record["vehicle"].replace(old, new)
    assert not verify(written(tmp_path / "r.json", record), log).proved
    record["inputs"][0]["sha256"] = hashlib.sha256(record["vehicle"].encode()).hexdigest()
    assert not verify(written(tmp_path / "r.json", record), log).proved


def test_certificates_that_are_swapped_dropped_or_renamed_are_refused(fits, tmp_path):
    files, log, _ = fits
    for name in ("pointwise", "empty"):
        record = json.loads(files[name].read_text())
        for number in range(len(record["certificates"])):
            edited = copy.deepcopy(record)
            del edited["certificates"][number]
            edited["certificate"] = [
                c for c in edited["certificates"] if c["proves"] == "empty" and c["block"] in edited["contradictions"]
            ] or None
            assert not verify(written(tmp_path / "r.json", edited), log).proved, (name, number)
    record = json.loads(files["pointwise"].read_text())
    bounds = [k for k, c in enumerate(record["certificates"]) if c["proves"] == "bound"]
    for a, b in pairwise(bounds):
        edited = copy.deepcopy(record)
        first, second = edited["certificates"][a], edited["certificates"][b]
        first["rows"], second["rows"] = second["rows"], first["rows"]
        first["signs"], second["signs"] = second["signs"], first["signs"]
        assert not verify(written(tmp_path / "r.json", edited), log).proved
    text = files["pointwise"].read_text()
    for old, new in (("mass.surge", "mass.sway"), ("mass.surge", "drag.surge.linear"), ("inertia.yaw", "x")):
        edited = json.loads(text.replace(f'"{old}"', f'"{new}"'))
        assert not verify(written(tmp_path / "r.json", edited), log).proved
    edited = json.loads(text)
    edited["parameters"]["mass.surge"]["unit"] = "g"
    assert not verify(written(tmp_path / "r.json", edited), log).proved


def test_orthants_that_are_left_out_are_refused(fits, tmp_path):
    files, log, _ = fits
    record = json.loads(files["pointwise"].read_text())
    cells = {tuple(c["orthant"].items()) for c in record["certificates"] if c["proves"] == "empty"}
    assert cells
    for cell in cells:
        edited = {**record, "certificates": [c for c in record["certificates"] if tuple(c["orthant"].items()) != cell]}
        verdict = verify(written(tmp_path / "r.json", edited), log)
        assert not verdict.proved and "not every cell of signs" in verdict.failures[0]


def test_without_its_seal_no_edit_passes(fits, tmp_path):
    files, log, _ = fits
    text = files["pointwise"].read_text()
    for old, new in (
        ('"inflation": 0.', '"inflation": 1.'),
        ('"guaranteed": true', '"guaranteed": false'),
        ("thrust accuracy", "thrust inaccuracy"),
    ):
        assert old in text
        (tmp_path / "r.json").write_text(text.replace(old, new, 1))
        verdict = verify(tmp_path / "r.json", log)
        assert not verdict.proved and "seal" in verdict.failures[0]
    (tmp_path / "r.json").write_text(text.replace("\n", "\n   "))
    assert verify(tmp_path / "r.json", log).proved


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


def leaves(value, path=()):
    """Paths of all numbers, hexadecimal ones included."""
    if isinstance(value, dict):
        for k, v in value.items():
            yield from leaves(v, (*path, k))
    elif isinstance(value, list):
        for k, v in enumerate(value):
            yield from leaves(v, (*path, k))
    elif (isinstance(value, (int, float)) and not isinstance(value, bool)) or (
        isinstance(value, str) and value.lstrip("-").startswith("0x")
    ):
        yield path


def at(record, path):
    for step in path:
        record = record[step]
    return record


@pytest.mark.slow
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], derandomize=True)
@given(
    data=st.data(),
    name=st.sampled_from(["pointwise", "integral", "empty"]),
    change=st.sampled_from(["ulp", "down", "scale", "sign", "shift", "other"]),
)
def test_edited_numbers_are_refused_or_claim_less(fits, tmp_path, data, name, change):
    """With the seal made anew: whatever is accepted holds what the original's vertices give."""
    files, log, _ = fits
    record = json.loads(files[name].read_text())
    paths = [p for p in leaves(record) if p[0] in ("certificates", "parameters", "options", "contradictions")]
    path = data.draw(st.sampled_from(paths))
    old = at(record, path)
    x = float.fromhex(old) if isinstance(old, str) else old
    other = at(record, data.draw(st.sampled_from(paths)))
    y = float.fromhex(other) if isinstance(other, str) else other
    new = {
        "ulp": math.nextafter(x, math.inf),
        "down": math.nextafter(x, -math.inf),
        "scale": x * 1.001,
        "sign": -x,
        "shift": x + 1,
        "other": y,
    }[change]
    if isinstance(old, int):
        new = round(new) if change != "ulp" else old + 1
    edited = copy.deepcopy(record)
    at(edited, path[:-1])[path[-1]] = float(new).hex() if isinstance(old, str) else new
    verdict = verify(written(tmp_path / "r.json", edited), log)
    if not verdict.proved:
        return
    for id_, p in edited["parameters"].items():
        proofs = [c for c in record["certificates"] if c["proves"] == "bound" and c["parameter"] == id_]
        for end, of in (("lower", min), ("upper", max)):
            proved = of(exact_end(record, c) for c in proofs if c["end"] == end)
            assert (Fraction(p[end]) <= proved) if end == "lower" else (Fraction(p[end]) >= proved), (path, change)


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
@pytest.mark.parametrize("rows", ["pointwise", "integral"])
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


@pytest.mark.parametrize(
    "edit",
    [
        lambda r: r["options"].update(form="other"),
        lambda r: r["options"].update(outliers=None),
        lambda r: r["options"].pop("outliers"),
        lambda r: r["options"].update(outliers=2),
        lambda r: r.update(outliers=[{"fewest": 2, "sets": [], "block": 0}]),
        lambda r: r["certificates"][0].update(dropped=[{"channel": "surge", "time": 0.0}]),
        lambda r: r["claims"].append({"parameter": "mass.surge", "value": 1.0, "contradicted": True}),
    ],
)
def test_options_and_statements_that_no_certificate_holds_are_not_proved(fits, tmp_path, edit):
    files, log, _ = fits
    path = files["pointwise"]
    record = json.loads(path.read_text())
    assert verify(path, log).proved
    edit(record)
    assert not verify(written(tmp_path / "result.json", record), log).proved


def test_claims_of_the_file_are_all_there_and_right(swan, twin, tmp_path):
    text = swan.text.split("[model]")[0] + '[model]\nterms = "paper"\nvalues = { "mass.surge" = 20.0 }\n'
    path = tmp_path / "log.csv"
    path.write_text(as_csv(twin.t, twin.columns))
    vehicle = parse_vehicle(text, "claims.toml")
    log = read_log(path, vehicle.log)
    fit = identify(vehicle, log)
    fit.save(tmp_path / "fit.json")
    assert fit.claims[0]["contradicted"] and verify(tmp_path / "fit.json", log).proved
    record = json.loads((tmp_path / "fit.json").read_text())
    for claims in ([], [{**record["claims"][0], "contradicted": False}], [{**record["claims"][0], "value": 21.0}]):
        assert not verify(written(tmp_path / "edited.json", {**record, "claims": claims}), log).proved


def test_a_key_that_stands_twice_is_refused(fits, tmp_path):
    files, log, _ = fits
    path = files["pointwise"]
    text = path.read_text()
    (tmp_path / "result.json").write_text(text.replace('{\n "ivsid"', '{\n "parameters": {},\n "ivsid"', 1))
    with pytest.raises(IvsidError, match="is not JSON"):
        verify(tmp_path / "result.json", log)
