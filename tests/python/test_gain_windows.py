"""The gain on a log whose lost rows leave no window to simulate over."""

from dataclasses import replace

import numpy as np

from diagnosis_logs import logs_of, vehicle_of
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.diagnosis.statements.comparison import compare


def test_a_log_without_a_window_has_forces_and_no_simulation():
    """A second is lost in every five: a log like it, of which 60 % of the rows were lost at random, ended in a traceback."""
    vehicle = vehicle_of()
    train, test = logs_of(vehicle, {})
    fit = plain_fit(vehicle, channels(train, vehicle), everything)
    kept = test.t % 5.0 > 1.0
    holes = replace(test, t=test.t[kept], columns={k: x[kept] for k, x in test.columns.items()})
    predictor = Predictor(vehicle, channels(holes, vehicle), fit.noise.predictor.ambient)
    other = replaced(fit.h, {"drag.surge.quadratic": 1.2 * fit.h.values["drag.surge.quadratic"]})
    gain = compare(predictor, fit.h, other)
    assert all(np.isnan(x) for pair in gain.simulation_rms.values() for x in pair)
    assert set(gain.interval) <= {"X", "Y", "N"} and np.isfinite(gain.force_rms["X"]).all()
    assert not {"u", "v", "r", "position"} & {*gain.losses, *gain.gains}
