"""Results that leave rows out: proved for every choice of wrong rows, and no edit of them passes."""

import copy
import json
import math
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from edited_results import written
from ivsid import identify, verify
from ivsid.log import Log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from ivsid.verification.errors import UnprovedError
from ivsid.verification.outliers import Proof, check_choices, left_open
from sampling import spaced
from test_verification_edits import exact_end, tightened

# Most edits leave the vehicle and the log as they were.
pytestmark = pytest.mark.same_rows

FIVE = (
    'terms = "paper"',
    'terms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.quadratic", "drag.sway.quadratic"]',
)
SPIKES = (200, 500, 800)


@pytest.fixture(scope="module")
def logs(swan, programme):
    """A clean log, and the same with three spikes of the accelerometer."""
    truth = {"mass.surge": 60.0, "inertia.yaw": 8.0, "drag.surge.quadratic": 250.0}
    made = simulate(swan, programme.model_copy(update={"noise": "uniform", "truth": truth, "duration": 60.0}), 3)
    spoilt = {k: v.copy() for k, v in made.columns.items()}
    spoilt["ax"][[*SPIKES]] += 0.5
    return Log("clean.csv", "0" * 64, made.t, made.columns), Log("spikes.csv", "0" * 64, made.t, spoilt)


@pytest.fixture(scope="module")
def saved(swan, logs, tmp_path_factory):
    """Results by name: the fit, its record, its log."""
    place, clean, spikes = tmp_path_factory.mktemp("outliers"), *logs
    five = parse_vehicle(swan.text.replace(*FIVE), "five.toml")
    asked = {
        "three": (swan, spikes, {"outliers": 3}),
        "two": (swan, spikes, {"outliers": 2}),
        "one": (five, clean, {"outliers": 1}),
        "windows": (swan, clean, {"outliers": 2, "rows": "integral"}),
        "both": (swan, clean, {"outliers": 1, "rows": "both", "window": [0.5, 1.0]}),
    }
    found = {}
    for name, (vehicle, log, how) in asked.items():
        fit = identify(vehicle, log, **how)
        fit.save(place / f"{name}.json")
        found[name] = fit, json.loads((place / f"{name}.json").read_text()), log
    return found


def rejected(record, log, tmp_path, words=""):
    verdict = verify(written(tmp_path / "r.json", record), log)
    return verdict.status == "failed" and any(words in f for f in verdict.failures), verdict.failures[:2]


@pytest.mark.parametrize(
    ("name", "status"),
    [("three", "enclosed"), ("two", "empty"), ("one", "enclosed"), ("windows", "enclosed"), ("both", "enclosed")],
)
def test_every_branch_of_the_tree_is_proved(saved, tmp_path, name, status):
    fit, record, log = saved[name]
    verdict = verify(written(tmp_path / "r.json", record), log)
    assert verdict.proved and verdict.claim == fit.status == status, verdict.failures[:3]
    deepest = max(len(c.get("dropped", ())) for c in record["certificates"])
    assert deepest == record["options"]["outliers"] and verdict.certificates == len(record["certificates"])


@pytest.mark.slow
@pytest.mark.sampled
def test_no_branch_can_be_left_out(saved, tmp_path):
    """Of each choice of wrong rows: without its certificates the claims do not stand, wherever they rest on it."""
    for name in ("three", "one"):
        _, record, log = saved[name]
        nodes = {
            (json.dumps(c["orthant"]), json.dumps(c.get("dropped", [])), c.get("parameter"), c.get("end"))
            for c in record["certificates"]
        }
        for node in spaced(sorted(nodes, key=str)[:: max(1, len(nodes) // 14)], 2):
            edited = copy.deepcopy(record)
            edited["certificates"] = [
                c
                for c in record["certificates"]
                if (json.dumps(c["orthant"]), json.dumps(c.get("dropped", [])), c.get("parameter"), c.get("end"))
                != node
            ]
            verdict = verify(written(tmp_path / "r.json", edited), log)
            assert verdict.proved == stands(edited), (name, node, verdict.failures[:2])
    # An orthant that is left out as a whole is never made up for.
    _, record, log = saved["one"]
    for signs in spaced(sorted({json.dumps(c["orthant"]) for c in record["certificates"]}), 6):
        edited = copy.deepcopy(record)
        edited["certificates"] = [c for c in record["certificates"] if json.dumps(c["orthant"]) != signs]
        assert rejected(edited, log, tmp_path)[0], signs


def stands(record):
    """By brute force over all choices of wrong rows that any certificate uses: does each claimed end follow?"""
    wrong = record["options"]["outliers"]

    def name(row):
        return row["channel"], row["time"]

    for id_, p in record["parameters"].items():
        mine = [c for c in record["certificates"] if id_ in c["orthant"]]
        for signs in {json.dumps(c["orthant"]) for c in mine}:
            cell = [c for c in mine if json.dumps(c["orthant"]) == signs]
            rows = sorted({name(r) for c in cell for r in c["rows"] if r["multiplier"]})
            for end, direction in (("lower", 1), ("upper", -1)):
                if direction * json.loads(signs)[id_] > 0 >= direction * p[end]:
                    continue
                enough = [
                    {name(r) for r in c["rows"] if r["multiplier"]}
                    for c in cell
                    if c["proves"] == "empty"
                    or (
                        ((c["parameter"], c["end"]) == (id_, end))
                        and direction * Fraction(float.fromhex(c["bound"])) >= direction * Fraction(p[end])
                    )
                ]
                choices = (set(d) for k in range(wrong + 1) for d in combinations(rows, k))
                if not all(any(not d & used for used in enough) for d in choices):
                    return False
    for block in record["outliers"]:
        cells = {}
        for c in record["certificates"]:
            if c["block"] == block["block"]:
                cells.setdefault(json.dumps(c["orthant"]), [])
                if c["proves"] == "empty":
                    cells[json.dumps(c["orthant"])].append({name(r) for r in c["rows"] if r["multiplier"]})
        sets = [{name(r) for r in chosen} for chosen in block["sets"]] or [set()]
        if any(all(any(not s & e for e in empties) for empties in cells.values()) for s in sets):
            return False
        for empties in cells.values():
            rows = sorted(set().union(*empties)) if empties else []
            for k in range((block["fewest"] or 0) + 1):
                for d in map(set, combinations(rows, k)):
                    closed = any(not d & e for e in empties)
                    if not closed and not (k == block["fewest"] and d in sets):
                        # Fewer rows, filled up, may be a choice that is named; then it is not the fewest.
                        return False
    return True


@pytest.mark.sampled
def test_one_ulp_beyond_any_branch_s_proof_is_refused(saved, tmp_path):
    _, record, log = saved["three"]
    bounds = [k for k, c in enumerate(record["certificates"]) if c["proves"] == "bound"]
    bounds = [k for k in bounds if math.isfinite(float.fromhex(record["certificates"][k]["bound"]))]
    for k in spaced(bounds[:: max(1, len(bounds) // 12)], 4):
        certificate = record["certificates"][k]
        edited = copy.deepcopy(record)
        edited["certificates"][k]["bound"] = tightened(exact_end(record, certificate), certificate["end"]).hex()
        passed, failures = rejected(edited, log, tmp_path, f"certificate {k}")
        assert passed, failures


@pytest.mark.sampled
def test_tighter_ends_are_refused(saved, tmp_path):
    for name in ("three", "one", "windows"):
        _, record, log = saved[name]
        ends = [(id_, end) for id_, p in record["parameters"].items() for end in ("lower", "upper") if p[end]]
        for id_, end in spaced(ends, 3):
            edited, x = copy.deepcopy(record), record["parameters"][id_][end]
            for _ in range(4):
                x = math.nextafter(x, math.inf if end == "lower" else -math.inf)
            edited["parameters"][id_][end] = x
            assert rejected(edited, log, tmp_path, f"the {end} end of {id_}")[0], (name, id_, end)


def test_a_certificate_does_not_stand_for_rows_that_it_uses(saved, tmp_path):
    """The proof without wrong rows, copied into every branch; and the tighter bounds that it would give."""
    _, record, log = saved["three"]
    edited = copy.deepcopy(record)
    first = {}
    for c in record["certificates"]:
        if not c.get("dropped"):
            first[json.dumps(c["orthant"]), c.get("parameter"), c.get("end")] = c
    for c in edited["certificates"]:
        key = json.dumps(c["orthant"]), c.get("parameter"), c.get("end")
        if c.get("dropped") and key in first:
            c["rows"] = copy.deepcopy(first[key]["rows"])
    assert rejected(edited, log, tmp_path)[0]
    # As if it used none of them: the rows that it leaves out are not believed.
    for c in edited["certificates"]:
        c.pop("dropped", None)
    assert rejected(edited, log, tmp_path)[0]


@pytest.mark.parametrize(
    "edit",
    [
        lambda r: r["options"].update(outliers=4),
        lambda r: r["options"].update(outliers=2),
        lambda r: r["options"].update(outliers=0),
        lambda r: r["options"].update(outliers=-3),
        lambda r: r["options"].update(outliers=True),
        lambda r: r["options"].update(bias="log"),
        lambda r: r["options"].update(rows="integral"),
        lambda r: r["outliers"].clear(),
        lambda r: r["outliers"].pop(),
        lambda r: r["outliers"].append({**r["outliers"][0], "block": 7}),
        lambda r: r["outliers"][0].update(fewest=0),
        lambda r: r["outliers"][0].update(fewest=0, sets=[]),
        lambda r: r["outliers"][0].update(fewest=2),
        lambda r: r["outliers"][0].update(fewest=None, sets=[]),
        lambda r: r["outliers"][0].update(fewest=2, sets=[s[:2] for s in r["outliers"][0]["sets"]]),
        lambda r: r["outliers"][0].update(fewest=4),
        lambda r: r["outliers"][0]["sets"].clear(),
        lambda r: r["outliers"][0]["sets"].append(r["outliers"][0]["sets"][0]),
        lambda r: r["outliers"][0]["sets"][0][0].update(time=r["outliers"][0]["sets"][0][0]["time"] + 0.05),
        lambda r: r["outliers"][0]["sets"].append(
            [{**x, "time": x["time"] + 1.0} for x in r["outliers"][0]["sets"][0]]
        ),
        lambda r: r["outliers"][1].update(fewest=1, sets=[r["outliers"][0]["sets"][0][:1]]),
        lambda r: r.update(status="empty", parameters={}, contradictions=[0]),
    ],
)
def test_edited_statements_on_wrong_rows_are_refused(saved, tmp_path, edit):
    _, record, log = saved["three"]
    edited = copy.deepcopy(record)
    edit(edited)
    assert rejected(edited, log, tmp_path)[0]


def test_that_more_rows_are_wrong_than_may_be_is_proved_and_not_for_more(saved, tmp_path):
    _, record, log = saved["two"]
    assert record["outliers"][0]["fewest"] is None
    for edit in (
        lambda r: r["options"].update(outliers=3),
        lambda r: r["outliers"][0].update(fewest=2, sets=[]),
        lambda r: r["outliers"][0].update(fewest=1),
        lambda r: r.update(certificates=[c for c in r["certificates"] if len(c.get("dropped", ())) < 2]),
    ):
        edited = copy.deepcopy(record)
        edit(edited)
        edited["certificate"] = [c for c in edited["certificates"] if c["proves"] == "empty" and c["block"] == 0]
        assert rejected(edited, log, tmp_path)[0]


def test_parameters_that_share_no_equation_have_wrong_rows_of_their_own(saved, tmp_path):
    """Two blocks told as one would share one number of wrong rows, and prove more than the assumption says."""
    _, record, log = saved["three"]
    edited = copy.deepcopy(record)
    ids = {c["block"]: list(c["orthant"]) for c in record["certificates"]}
    assert len(ids) == 2
    whole = ids[0] + ids[1]
    for c in edited["certificates"]:
        own = list(c["orthant"])
        c["orthant"] = {k: c["orthant"].get(k, 0) for k in whole}
        c["block"] = 0
        for row in c["rows"]:
            for key in ("lower", "upper"):
                row[key] = [dict(zip(own, row[key], strict=True)).get(k, (0.0).hex()) for k in whole]
    edited["outliers"] = edited["outliers"][:1]
    passed, failures = rejected(edited, log, tmp_path, "shares no equation")
    assert passed, failures


def test_rows_that_were_not_counted_prove_nothing(swan, saved, tmp_path):
    """Rows of another kind or another window are not among those of which so many may be wrong."""
    _, record, log = saved["both"]
    assert {r["kind"] for c in record["certificates"] for r in c["rows"]} >= {"pointwise", "integral"}
    for change in ({"rows": "pointwise"}, {"rows": "auto"}, {"window": 2.0}, {"window": [0.5]}):
        edited = copy.deepcopy(record)
        edited["options"].update(change)
        if change == {"window": [0.5]} and not any(
            r["duration"] > 0.9 for c in record["certificates"] for r in c["rows"]
        ):
            continue
        assert rejected(edited, log, tmp_path)[0], change


def test_another_log_is_refused(saved, tmp_path):
    _, record, log = saved["three"]
    for k in (SPIKES[0], 333):
        columns = {n: v.copy() for n, v in log.columns.items()}
        columns["u"][k - 40 : k + 40] += 0.05
        verdict = verify(written(tmp_path / "r.json", record), Log(log.name, log.sha256, log.t, columns))
        used = {r["time"] for c in record["certificates"] for r in c["rows"]}
        touched = any(log.t[k - 40] <= t < log.t[k + 40] for t in used)
        assert (verdict.status == "failed") == touched, verdict.failures[:2]
    assert verify(written(tmp_path / "r.json", record), Log(log.name, "1" * 64, log.t, log.columns)).status == "failed"


ROWS = st.frozensets(st.integers(0, 6), max_size=4)


@settings(max_examples=300, deadline=None)
@given(st.lists(st.tuples(ROWS, ROWS), max_size=8), st.integers(0, 3))
def test_what_touches_every_proof_is_found_as_by_brute_force(families, wrong):
    """Whatever the proofs say that they were made for."""

    def named(rows):
        return frozenset(("pointwise", "surge", float(k), 0.0) for k in rows)

    proofs = [Proof(None, None, named(used), named(meant)) for used, meant in families]
    everything = named(range(7))
    hits = [
        set(d) for k in range(wrong + 1) for d in combinations(everything, k) if all(p.rows & set(d) for p in proofs)
    ]
    found = left_open(proofs, wrong)
    assert (found is None) == (not hits)
    if found is not None:
        assert len(found) <= wrong and all(p.rows & found for p in proofs)


def test_choices_of_wrong_rows_are_those_that_the_proofs_leave():
    """Two rows a and b that contradict each other, and c: a or b is wrong."""

    def row(k):
        return {"kind": "pointwise", "channel": "surge", "time": float(k), "duration": 0.0}

    def of(*rows):
        return frozenset(("pointwise", "surge", float(k), 0.0) for k in rows)

    cells = [[Proof(None, None, of(0, 1))], [Proof(None, None, of(0, 1)), Proof(None, None, of(2))]]
    check_choices({"fewest": 1, "sets": [[row(0)], [row(1)]]}, cells, 1)
    for claim in (
        {"fewest": 1, "sets": [[row(0)]]},
        {"fewest": 1, "sets": [[row(0)], [row(1)], [row(2)]]},
        {"fewest": 0, "sets": []},
        {"fewest": None, "sets": []},
        {"fewest": 2, "sets": [[row(0), row(1)]]},
        {"fewest": True, "sets": [[row(0)], [row(1)]]},
    ):
        with pytest.raises(UnprovedError):
            check_choices(claim, cells, 1)
    check_choices({"fewest": None, "sets": []}, [[Proof(None, None, of(0)), Proof(None, None, of(1))]], 1)
    assert np.all([left_open([Proof(None, None, of())], q) is None for q in range(5)])
