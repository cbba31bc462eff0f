"""``ivsid verify`` on edited results: refused, or the claim is still true."""

import copy
import json
import math
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from edited_results import resealed, written
from ivsid import identify, verify
from ivsid.errors import IvsidError
from ivsid.intervals import outward_decimal
from ivsid.log import read_log
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.log_files import csv as as_csv
from sampling import NIGHTLY, spaced

# Most edits leave the vehicle and the log as they were.
pytestmark = pytest.mark.same_rows


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
@pytest.mark.sampled
def test_one_ulp_beyond_the_proof_is_refused(fits, tmp_path, name):
    files, log, _ = fits
    record = json.loads(files[name].read_text())
    proved = [
        (number, certificate)
        for number, certificate in enumerate(record["certificates"])
        if certificate["proves"] == "bound" and math.isfinite(float.fromhex(certificate["bound"]))
    ]
    for number, certificate in spaced(proved, 3):
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
@settings(
    max_examples=60 if NIGHTLY else 25,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
    derandomize=True,
)
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
