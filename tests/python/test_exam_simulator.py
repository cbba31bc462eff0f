"""The examiner's own simulator beside the package's: two programs of one definition, so that neither drifts."""

from pathlib import Path

import numpy as np
import pytest
from tests.exam.cases import setting
from tests.exam.catalogue import EFFECTS as HIDDEN
from tests.exam.catalogue import ON_TEST_ALONE, OUTSIDE

from ivsid.effects import EFFECTS, sort_given
from ivsid.simulation import follow
from ivsid.simulation.sensing import sensed
from ivsid.vehicle import parse_vehicle
from sampling import spaced

# Simpson's rule, Hermite's cubic and fixed steps on one side; adaptive steps and a parabola on the other.
CLOSE = 1e-4
DURATION = 15.0


def both(kind, id_, size=3.0):
    """Readings without noise, of the examiner and of the package, under the same commands, in still water."""
    here = setting(14, kind=kind, style="rich", ambient=1.0, duration=DURATION, rate=10.0, thrust="none")
    truth = {} if id_ is None else here.draw(id_, size)
    mine, _ = here.sailed(truth, int(id_ in ON_TEST_ALONE), calm=True)
    text = here.text.replace("accuracy = { absolute", "#accuracy = { absolute")
    vehicle = parse_vehicle(text, "v.toml")
    names = [t.name for t in vehicle.thrusters]
    m = mine.motion
    values = {**here.exact, **truth}
    other = follow(
        vehicle,
        values,
        m.t,
        dict(zip(names, m.demands.T, strict=True)),
        angles=dict(zip(names, m.angles.T, strict=True)),
    )
    read = sensed(vehicle, m.t, other, sort_given(values, names))
    return mine.clean, {k: read[k] for k in mine.clean}


def test_the_examiner_hides_every_effect_of_the_catalogue():
    assert set(HIDDEN) == {e.id for e in EFFECTS.values() if not e.plain}
    assert not set(OUTSIDE) & set(EFFECTS)


@pytest.mark.sampled
@pytest.mark.parametrize(
    ("kind", "id_"),
    [
        *((kind, None) for kind in ("twin", "tug", "steered", "azimuth")),
        *(("vectored", i) for i in spaced(sorted(HIDDEN), 6)),
    ],
)
def test_the_examiners_motion_is_that_of_the_package(kind, id_):
    mine, other = both(kind, id_)
    plain = mine if id_ is None else both(kind, None)[0]
    for k in mine:
        size = np.abs(mine[k]).max()
        np.testing.assert_allclose(mine[k], other[k], atol=CLOSE * size + 1e-9, err_msg=f"{kind} {id_} {k}")
    if id_ is not None:
        # The effect moves a reading by far more than that.
        assert any(np.abs(mine[k] - plain[k]).max() > 20 * CLOSE * np.abs(plain[k]).max() for k in mine), id_


def test_the_examiners_programs_share_nothing_with_the_diagnosis():
    """Its physics, sensors and z are written from the definitions; of the package they take the helm alone."""
    folder = Path(__file__).parents[1] / "exam"
    for name in (
        "catalogue",
        "physics",
        "readings",
        "shown",
        "simulator",
        "thrust_curves",
        "thrust_errors",
        "vessels",
        "cases",
    ):
        lines = [q for q in (folder / f"{name}.py").read_text().splitlines() if "ivsid" in q and "import" in q]
        allowed = ("ivsid.programme", "ivsid.vehicle import Vehicle")
        assert all(any(a in q for a in allowed) for q in lines), (name, lines)
