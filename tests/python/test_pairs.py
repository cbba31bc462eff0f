"""Two causes in one log: a strong one leaves the weaker one its name."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2]))
from tests.exam.cases import case
from tests.exam.seal import seal

from diagnosis_logs import names
from ivsid import diagnose
from ivsid.log import read_log
from ivsid.vehicle import read_vehicle


def diagnosed(seed, folder, **given):
    folder = seal(case(seed, duration=300.0, **given), folder, folder / "answers")
    vehicle = read_vehicle(folder / "vehicle.toml")
    return diagnose(vehicle, *(read_log(folder / f"{k}.csv", vehicle.log) for k in (1, 2)))


@pytest.mark.nightly
def test_the_force_of_a_tide_that_is_found_does_not_stay_in_the_ambient_one(tmp_path):
    """A tide of 226 standard deviations was ambient force: beside it the sea looked 4.8 times as rough as declared, and the verdict was unknown, too."""
    said = diagnosed(83139, tmp_path)
    assert "unknown" not in {f.effect for f in said.findings} and {"current.oscillating"} in names(said)
    before, after = (fit.noise.predictor.ambient.deviation[1] for fit in (said.selection.plain, said.selection.last))
    assert after < 0.6 * before and said.adequacy[1].rougher[1] < 1.5
