"""Functions of the dictionary that the adequacy test knows and the catalogue does not."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from diagnosis_logs import train_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.selection.adequacy import adequacy

# The water of the test forgets more quickly than the dictionary's.
FORGETS = 6.0


@pytest.fixture(scope="module")
def fit():
    vehicle = vehicle_of()
    return plain_fit(vehicle, channels(train_of(vehicle), vehicle), everything)


def remembered(x, h, time):
    """A quantity on straight lines behind a first-order lag, by Runge and Kutta's rule (the oracle shares no filter with the product)."""
    t = h * np.arange(x.size)
    done = solve_ivp(lambda s, y: (np.interp(s, t, x) - y) / time, (0.0, t[-1]), [0.0], t_eval=t, max_step=h)
    return done.y[0]


@pytest.mark.parametrize(("share", "quiet"), [(0.0, True), (1.0, False)])
def test_a_force_of_what_the_water_remembers_is_no_noise(fit, share, quiet):
    """A sway force of twice the declared ambient one, by a velocity of half a minute before, was adequate."""
    predictor, n = fit.noise.predictor, fit.noise.predictor.log.n
    v = fit.states.points.nu[1]
    past = remembered(v[:n], predictor.log.h, FORGETS)
    past *= 4.0 * predictor.ambient.deviation[1] / past.std()
    process = np.zeros((3, 2 * n))
    process[1] = np.concatenate([past, past])
    errors = predictor.errors(fit.states) + share * predictor.answer(process)
    found = adequacy(replace(fit, gram=fit.gram.of(errors)))
    assert found.white == quiet
    assert quiet or found.strongest[0][:2] == ("past v", "sway")
