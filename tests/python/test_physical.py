"""Bounds that every vessel keeps: what contradicts them is said, and what assumes them is proved."""

import json
import re
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from conftest import as_log
from edited_results import written
from ivsid import identify, verify
from ivsid.effects import CATALOGUE, on_hull, terms_of
from ivsid.errors import IvsidError
from ivsid.identification import read_identification
from ivsid.identification.physics import of_no_vessel
from ivsid.intervals import IntervalArray
from ivsid.physical import MOST, Subject, faults
from ivsid.physical.drag import is_drag
from ivsid.vehicle import parse_vehicle
from ivsid.verification.physical import DRAGS
from ivsid.workflow.identification import identification_report

HULL = 'name = "v"\n[hull]\nmass = 50\nlength = 1.2\n'
TRUTH = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}


def subject(terms="", hull=HULL, half=0.01):
    """A model with velocities of a fixed draw, whose intervals have a half-width."""
    vehicle = parse_vehicle(hull + terms, "v.toml")
    nu = np.random.default_rng(1).normal(size=(3, 200))
    u, v, r = (IntervalArray(x - half, x + half) for x in nu)
    return Subject(vehicle, terms_of(vehicle), (u, v, r), np.arange(200.0))


def point(**changes):
    return {k: (x, x) for k, x in (TRUTH | {k.replace("_", "."): x for k, x in changes.items()}).items()}


def test_a_vessel_keeps_every_bound_and_an_open_set_contradicts_none():
    assert faults(subject(), point()) == ()
    assert faults(subject(), dict.fromkeys(TRUTH, (-np.inf, np.inf))) == ()


@pytest.mark.parametrize(
    ("changes", "bound", "words"),
    [
        ({"mass_surge": 20000.0}, "physical.most", "total mass in surge is at least 20000 kg, more than the 500 kg"),
        ({"mass_sway": 10.0}, "physical.least", "total mass in sway is at most 10 kg, less than the 25 kg"),
        ({"inertia_yaw": 900.0}, "physical.most", "moment of inertia is at least 900 kg m^2, more than the 180 kg m^2"),
        ({"inertia_yaw": -1.0}, "physical.least", "moment of inertia is at most -1 kg m^2"),
        ({"mass_surge": -5.0}, "physical.inertia", "not positive definite"),
        ({"drag_sway_quadratic": -3.0}, "physical.drag", "the drags in sway drive: at v ="),
        ({"drag_surge_quadratic": -400.0}, "physical.power", "W or more"),
    ],
)
def test_what_no_vessel_has_is_said_of_each_bound(changes, bound, words):
    found = {f.bound: f for f in faults(subject(), point(**changes))}
    assert words in found[bound].sentence
    assert set(found[bound].parameters) & {k.replace("_", ".") for k in changes}


def test_a_point_of_a_vessel_is_not_called_strange():
    kept = {k: low for k, (low, _) in point().items()}
    assert of_no_vessel(subject(), kept) == () and of_no_vessel(subject(), {}) == ()
    (said,) = of_no_vessel(subject(), {**kept, "mass.sway": -985.0})
    assert (
        said.startswith("no vessel has the parameter of least inflation (") and "is no estimate of the vessel" in said
    )


def test_the_limits_are_those_of_the_hull():
    """Half and ten times the dry mass; ten times the mass at the ends of the hull."""
    for value, bad in ((24.9, True), (25.1, False), (MOST * 50 - 0.1, False), (MOST * 50 + 0.1, True)):
        assert bool(faults(subject(), point(mass_surge=value))) == bad
    largest = 10 * 50 * 1.2**2 / 4
    for value, bad in ((largest - 0.1, False), (largest + 0.1, True)):
        assert bool(faults(subject(), point(inertia_yaw=value))) == bad
    bare = subject(hull=HULL.replace("length = 1.2\n", ""))
    assert faults(bare, point(inertia_yaw=1e5)) == ()


def test_a_matrix_with_positive_masses_may_be_none():
    terms = '[model]\nterms = ["mass.surge", "mass.sway", "inertia.yaw", "coupling.cg_x", "drag.surge.quadratic"]\n'
    kept = {"mass.surge": 58.0, "mass.sway": 75.0, "inertia.yaw": 9.0, "drag.surge.quadratic": 28.0}
    # 75 kg times 9 kg m^2 is 675 kg^2 m^2, the square of 25.98 kg m.
    for coupling, bounds in ((25.9, []), (26.1, ["physical.inertia"])):
        box = {k: (x, x) for k, x in (kept | {"coupling.cg_x": coupling}).items()}
        assert [f.bound for f in faults(subject(terms), box)] == bounds


@pytest.mark.parametrize("form", ["total", "added"])
def test_a_matrix_that_is_positive_definite_by_less_than_a_rounding_is_no_fault(form):
    """The inertia is the smallest double for which all leading minors are positive, in fractions of the file's decimals."""
    terms = '[model]\nterms = ["mass.surge", "mass.sway", "inertia.yaw"]\n'
    rng = np.random.default_rng(8)
    # Parameters whose products are exact, so that no rounding of theirs hides one of the file's numbers.
    surge, sway = (64.0, 32.0) if form == "total" else (0.0, 0.0)
    for _ in range(150):
        mass, length, x_g, y_g = (round(rng.uniform(*e), 3) for e in ((20, 90), (0.5, 3), (-0.3, 0.3), (-0.2, 0.2)))
        hull = f'name = "v"\n[hull]\nmass = {mass!r}\nlength = {length!r}\ncentre_of_gravity = [{x_g!r}, {y_g!r}]\n'
        vehicle = parse_vehicle(hull + terms, "v.toml")
        one = replace(
            subject(), vehicle=vehicle, terms=terms_of(vehicle, form), known_mass=mass if form == "added" else 0.0
        )
        dry, known = Fraction(repr(mass)), Fraction(repr(mass)) if form == "added" else Fraction(0)
        # Schur's complement of the masses: I > (m x_G)^2 / m_sway + (m y_G)^2 / m_surge.
        along, across = ((dry * Fraction(repr(x))) ** 2 / (known + Fraction(m)) for x, m in ((x_g, sway), (y_g, surge)))
        inertia = float(along + across)
        inertia = inertia if Fraction(inertia) > along + across else float(np.nextafter(inertia, np.inf))
        assert along + across < Fraction(inertia) <= (along + across) * (1 + Fraction(1, 2**50))
        for value, held in ((inertia, True), (inertia * (1 - 1e-9), False)):
            box = {t.id: (x, x) for t, x in zip(one.terms, (surge, sway, value), strict=True)}
            assert ("physical.inertia" in [f.bound for f in faults(one, box)]) != held


def test_a_negative_drag_may_be_made_up_for_by_another_inside_the_velocities_alone():
    """-5 u + 28 u|u| drives below 5/28 m/s and nowhere else."""
    terms = '[model]\nterms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear", "drag.surge.quadratic"]\n'
    box = {"mass.surge": 58.0, "mass.sway": 75.0, "inertia.yaw": 9.0} | {
        "drag.surge.linear": -5.0,
        "drag.surge.quadratic": 28.0,
    }
    ends = {k: (x, x) for k, x in box.items()}
    one = subject(terms)
    for speed, bad in ((0.3, False), (0.1, True)):
        u = IntervalArray(np.full(3, speed), np.full(3, speed))
        still = IntervalArray(np.zeros(3))
        assert bool(faults(replace(one, velocities=(u, still, still), time=np.arange(3.0)), ends)) == bad
    # A velocity whose sign is open says nothing.
    open_ = IntervalArray(np.full(3, -0.01), np.full(3, 0.11))
    assert not faults(replace(one, velocities=(open_, still, still), time=np.arange(3.0)), ends)


def test_the_checker_names_the_drags_that_the_definitions_show():
    vehicle = parse_vehicle(HULL, "v.toml")
    assert {id_ for id_, t in CATALOGUE.items() if is_drag(on_hull(t, vehicle))} == DRAGS


@pytest.fixture(scope="module")
def backward(swan, twin):
    """The twin's log under a file whose thrusts have the wrong sign: a guaranteed set of no vessel."""
    text, turned = re.subn(r"azimuth = [\d.]+", "azimuth = 3.141592653589793", swan.text)
    assert turned == 2
    return parse_vehicle(text, "v.toml"), as_log(twin)


def test_a_guaranteed_set_that_no_vessel_has_is_noted_in_record_terminal_and_page(backward, tmp_path):
    fit = identify(*backward)
    assert fit.guaranteed and fit.parameters["mass.surge"].upper < 0
    assert {"physical.least", "physical.drag"} <= {f["bound"] for f in fit.physical}
    report = identification_report(fit, backward[1])
    assert report.record["physical"] == list(fit.physical) or list(report.record["physical"]) == list(fit.physical)
    assert "no vessel has these parameters" in report.summary
    said = [line for line in report.lines if "no vessel has these parameters" in line]
    assert len(said) == len(fit.physical) and all("(proved)" in line for line in said)
    assert any("total mass in surge is at most" in line for line in said)
    fit.save(tmp_path / "result.json")
    assert read_identification(tmp_path).physical == fit.physical


def test_physical_rows_falsify_such_a_file_and_the_checker_agrees(backward, tmp_path):
    fit = identify(*backward, physical=True)
    assert fit.status == "empty" and not fit.physical
    # The point nearest to such a log is no vessel's, and says so.
    assert any(note.startswith("no vessel has the parameter of least inflation (") for note in fit.notes)
    assert any("(of no vessel, see the note)" in line for line in identification_report(fit, backward[1]).lines)
    fit.save(tmp_path / "result.json")
    verdict = verify(tmp_path, backward[1])
    assert verdict.proved and verdict.claim == "empty", verdict.failures


@pytest.fixture(scope="module")
def assumed(swan, twin, tmp_path_factory):
    """A model of eight terms on a log of 15 s, which leaves much open, with and without the physical bounds."""
    text = swan.text.split("[model]")[0] + (
        '[model]\nterms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear", "drag.surge.quadratic", '
        '"drag.sway.linear", "drag.sway.quadratic", "drag.yaw.linear"]\n'
    )
    vehicle, log = parse_vehicle(text, "v.toml"), as_log(twin)
    short = replace(log, t=log.t[:150], columns={k: x[:150] for k, x in log.columns.items()})
    place = tmp_path_factory.mktemp("assumed")
    fit = identify(vehicle, short, physical=True)
    fit.save(place / "result.json")
    return identify(vehicle, short), fit, short, place


def test_physical_bounds_narrow_a_set_hold_the_truth_and_stand_in_assumes(assumed, programme):
    free, fit, _, _ = assumed
    ends = {k: (free.parameters[k], p) for k, p in fit.parameters.items()}
    assert all(a.lower <= b.lower and b.upper <= a.upper for a, b in ends.values())
    assert any(a.lower < b.lower or b.upper < a.upper for a, b in ends.values())
    for id_, p in fit.parameters.items():
        # The twin has one mass and one drag for surge and sway.
        true = programme.truth.get(id_.replace("sway", "surge"), 0.0)
        assert p.lower <= true <= p.upper
    assert any("each total mass is between 0.5 and 10 times" in a for a in fit.assumes)
    assert any("drags (drag.surge.linear" in a for a in fit.assumes)
    assert not any("total mass" in a or a.startswith("drags") for a in free.assumes)
    assert fit.guaranteed and fit.options["physical"] and not free.options["physical"]
    # Assumptions are no rows of the log.
    assert fit.rows == free.rows


def test_the_checker_proves_what_assumes_physical_bounds_and_nothing_else(assumed):
    _, _, log, place = assumed
    assert verify(place, log).proved
    record = json.loads((place / "result.json").read_text())
    used = [r for c in record["certificates"] for r in c.get("rows", ()) if str(r["kind"]).startswith("physical.")]
    assert {r["kind"] for r in used} >= {"physical.drag"}
    edits = []
    without = json.loads(json.dumps(record))
    without["options"]["physical"] = False
    edits.append(("assume no physical bounds", without))
    for kind, key, change in (
        ("physical.drag", "right", lambda x: [(0.5).hex(), x[1]]),
        ("physical.drag", "side", lambda _: "upper"),
        ("physical.drag", "right", lambda x: [x[0], (0.0).hex()]),
        ("physical.drag", "lower", lambda x: [(float.fromhex(e) + 1.0).hex() for e in x]),
    ):
        edited = json.loads(json.dumps(record))
        row = next(r for c in edited["certificates"] for r in c.get("rows", ()) if r["kind"] == kind)
        row[key] = change(row[key])
        edits.append((key, edited))
    for what, edited in edits:
        assert verify(written(place / "edited.json", edited), log).status == "failed", what


def test_the_checker_reckons_the_mass_limits_by_itself(assumed):
    from ivsid.verification.rows import Rows

    _, fit, log, _ = assumed
    rows = Rows(log, fit.vehicle, "total", assumed=True)
    mass = Fraction(str(fit.vehicle.hull.mass))
    for kind, least in (("physical.least", mass / 2), ("physical.most", -10 * mass)):
        made = rows.row(kind, "surge", float(log.t[0]), 0.0)
        assert made.right.lower <= least <= made.right.upper
        assert {k for k, x in made.matrix.items() if x.magnitude} == {"mass.surge"}


@pytest.mark.parametrize("how", [{"method": "exact"}, {"outliers": 1}])
def test_physical_bounds_need_inequalities_without_outliers(swan, twin, how):
    with pytest.raises(IvsidError, match="use feasible without outliers"):
        identify(swan, as_log(twin), physical=True, **how)
