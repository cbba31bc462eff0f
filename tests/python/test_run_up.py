"""How a log began: thrusters that run up and filters that forget, before any sample counts."""

from dataclasses import replace

import pytest

from diagnosis_logs import TWIN, train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation import noise
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.noise import declared_ambient, settled_after, usable_rows
from ivsid.diagnosis.prediction.innovations import Predictor
from ivsid.errors import IvsidError
from ivsid.vehicle import parse_vehicle

CALM = (("force = 0.15", "force = 0.002"), ("moment = 0.03", "moment = 0.0004"))


def late(seconds, *changes):
    """The boat with thrusters that lag."""
    text = vehicle_of(TWIN.replace("accuracy", f"time_constant = {seconds}\naccuracy")).text
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return parse_vehicle(text, "late.toml")


def test_no_sample_counts_while_thrusters_run_up():
    """Six seconds of lag are thirty of run-up; a gap later on takes no more than filters need for one."""
    vehicle = late(6.0)
    log = channels(train_of(vehicle, duration=120.0), vehicle)
    gap = log.good.copy()
    gap[800] = False
    predictor = Predictor(vehicle, replace(log, good=gap), declared_ambient(vehicle))
    after = settled_after(predictor)
    assert 34.0 <= after < 45.0
    good = usable_rows(predictor)
    first = round(after / log.h)
    assert not good[:first].any() and good[first:800].all() and good[801 + round(4.0 / log.h) :].all()
    assert not good[800 : 800 + round(4.0 / log.h)].any()


@pytest.mark.parametrize("counted", [True, False])
def test_thrusters_that_stood_still_are_no_drag(counted, monkeypatch):
    """A demand that was there before the log began would have run the thrusters up: the model takes them as running, whatever they did."""
    vehicle = late(0.5, *CALM)
    train = train_of(vehicle, duration=240.0)
    if not counted:
        monkeypatch.setattr(noise, "settled_after", lambda predictor: 0.5)
    scored = score(plain_fit(vehicle, channels(train, vehicle), everything))[1]
    best = max(s.fall for s in scored if not s.candidate.searched)
    # Of some forty causes in noise the best has about ten.
    assert best < 20.0 if counted else best > 25.0


def test_a_log_that_ends_as_thrusters_have_run_up_is_refused_in_a_sentence():
    vehicle = late(8.0)
    log = channels(train_of(vehicle, duration=75.0), vehicle)
    with pytest.raises(
        IvsidError, match=r"after 4\d s in which its thrusters run up.*3\d s can be used.*give a longer log"
    ):
        plain_fit(vehicle, log, everything)
