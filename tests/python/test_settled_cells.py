"""Thrust errors that jump inside the usual cells of demand, in a calm sea where each jump stands out: as many cells as the log asks for."""

from dataclasses import replace
from types import SimpleNamespace

import pytest
from tests.exam.cases import case
from tests.exam.seal import seal

from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.round import Round
from ivsid.diagnosis.null.screening import CLOSER_CURVE, Case
from ivsid.diagnosis.null.visibility import visibility
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.log import read_log
from ivsid.vehicle import read_vehicle

CHANCE = 1e-4


def screened(folder):
    vehicle = read_vehicle(folder / "vehicle.toml")
    fit, scored = score(plain_fit(vehicle, channels(read_log(folder / "1.csv", vehicle.log), vehicle), everything))
    return SimpleNamespace(fit=fit, round=Round(fit, scored, CHANCE, visibility(fit)), by={s.id: s for s in scored})


@pytest.fixture(scope="module")
def levels(tmp_path_factory):
    """Nothing is hidden: errors of four thrusters between two levels, at 0.99 of the accuracy, which is six times the ambient force."""
    folder = tmp_path_factory.mktemp("levels")
    return screened(seal(case(300890, sea="any", sensors="any"), folder, folder / "answers"))


def test_errors_that_jump_inside_cells_are_no_cause_however_far_they_stand_out(levels):
    r = levels.round
    assert r.unsettled and r.reached.leaving > 1000.0
    cap, failure = levels.by["thruster.saturation"], levels.by["thruster.failure"]
    assert cap.fall > 400.0 and r.directions.left(cap) > 400.0 and r.finer_directions.left(cap) > 25.0
    assert r.left(cap) < 1.0
    # Evidence of errors that leave their bounds beside the usual cells is none beside more of them, and does
    # not keep other causes from standing beside slow forces.
    assert r.in_box(cap).boxed > 1000.0 and not replace(r, scored=[r.in_box(cap)]).strong
    for cause in (cap, failure):
        assert CLOSER_CURVE.refuses(Case(r, r.in_box(cause))) is not None


def test_such_a_log_is_adequate_for_its_model(levels):
    left = adequacy(levels.fit)
    assert left.quiet and left.bounded and left.white


def test_a_cap_has_no_more_to_fear_of_more_cells(tmp_path):
    """What no error inside its bound makes of a cap is the same beside six times the cells."""
    there = screened(
        seal(case(262683, what="one", effect="thruster.saturation", sea="any", sensors="any"), tmp_path, tmp_path / "a")
    )
    cap = there.by["thruster.saturation"]
    assert not there.round.unsettled
    assert there.round.finest_directions.left(cap) > 0.9 * there.round.directions.left(cap) > 1000.0
    assert CLOSER_CURVE.refuses(Case(there.round, there.round.in_box(cap))) is None and there.round.strong
