"""Hints of an ambient force that is larger than the vehicle file declares: in one axis, or in both, where one sea makes them."""

import pytest

from diagnosis_logs import train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.prediction.axes import Ambient
from ivsid.diagnosis.statements.hints import hints


@pytest.fixture(scope="module")
def fit():
    vehicle = vehicle_of()
    return plain_fit(vehicle, channels(train_of(vehicle), vehicle), everything)


@pytest.mark.parametrize(
    ("times", "said"),
    [
        ((1.9, 1.9), None),
        ((5.0, 1.0), "the ambient force in surge looks like"),
        ((1.0, 5.0), "the ambient force in sway looks like"),
        ((5.0, 6.0), "the ambient force looks like"),
    ],
)
def test_an_ambient_force_of_one_axis_may_be_another_one(fit, times, said, monkeypatch):
    predictor = fit.noise.predictor
    masses = fit.h.values["mass.surge"], fit.h.values["mass.sway"]
    force = predictor.vehicle.ambient.force
    x, y = (k * force / m for k, m in zip(times, masses, strict=True))
    monkeypatch.setattr(predictor, "ambient", Ambient((x, y, 1e-3), (2.0, 2.0, 2.0)))
    found = [h for h in hints(fit) if "ambient force" in h]
    if said is None:
        assert found == []
    else:
        (one,) = found
        assert one.startswith(f"{said} {5 * force:.2g} N rms")
        # A sea pushes both ways.
        assert ("a force that the model lacks" in one) == (" in " in said)
