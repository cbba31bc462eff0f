"""Share of the error in position that a cause explains: free runs of a minute, with the interval that the log allows."""

import numpy as np
import pytest
from tests.exam.draw import case

from ivsid import diagnose
from ivsid.diagnosis.statements.share import Share
from ivsid.log import Log


def log_of(made, name):
    return Log(name, "0" * 64, made.t, made.columns)


def test_a_share_tells_only_what_lies_off_zero():
    assert Share(10.0, 5.0, (0.6, 0.9)).share == pytest.approx(0.75)
    assert Share(10.0, 5.0, (0.6, 0.9)).told and not Share(10.0, 9.0, (-0.2, 0.6)).told
    assert Share(5.0, 10.0, (-5.0, -1.0)).told and Share(5.0, 10.0, (-5.0, -1.0)).share == pytest.approx(-3.0)


# Nightly: a whole diagnosis of a long log.
@pytest.mark.nightly
def test_a_current_explains_a_part_of_a_free_run():
    # The free runs of this log keep their heading; where they do not, no share of a cause is told.
    c = case(
        4,
        what="one",
        effect="current.steady",
        size=1.5,
        kind="catamaran",
        style="rich",
        ambient=0.05,
        duration=500.0,
        rate=10.0,
    )
    result = diagnose(c.vehicle, log_of(c.train, "1.csv"), log_of(c.test, "2.csv"), null_logs=0)
    (f,) = result.findings
    m = f.matters
    assert f.effect == "current.steady" and m.told and 0.0 < m.interval[0] <= m.share <= m.interval[1] <= 1.0
    # The current alone moves the vehicle by its speed times a minute at most.
    speed = np.hypot(c.truth["current.steady.north"], c.truth["current.steady.east"])
    assert 0.0 < m.without - m.held < 60.0 * speed
    record = f.record()["matters"]
    assert record["after"] == 60.0 and record["share"] == pytest.approx(1 - (m.held / m.without) ** 2)
