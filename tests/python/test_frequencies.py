"""The strength of the noise at a cause's frequencies: 1 in white noise, that of the spectrum in any other, and no more for a cause that is there."""

from dataclasses import replace

import numpy as np
import pytest
from diagnosis_logs import boat, train_of

from ivsid.diagnosis.candidates.families import everything, score
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.null.frequencies import strength
from tests.exam.cases import case
from tests.exam.seas import SEAS

from ivsid.diagnosis import diagnose


@pytest.fixture(scope="module")
def fit():
    vehicle = boat()
    return score(plain_fit(vehicle, channels(train_of(vehicle, duration=300.0), vehicle), everything))


def with_errors(fit, row):
    """The fit to whitened errors that are drawn: the same in every row."""
    g = fit.gram
    rows = len(fit.noise.predictor.labels)
    y = np.stack([row] * rows).reshape(rows, len(g.y), g.length).transpose(1, 0, 2).reshape(g.y.shape)
    scores = np.concatenate([(p.transpose(1, 0, 2) @ y[:, :, None])[:, :, 0] for p in g.parts], axis=1)
    return replace(fit, gram=replace(g, y=y, score=scores, energy=(y**2).sum(axis=1)))


def one(scored, id_):
    return next(s for s in scored if s.id == id_)
