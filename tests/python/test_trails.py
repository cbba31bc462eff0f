"""Memories of the path: the examiner tows a body on a cable, which follows a tractrix of the way that the boat makes without it."""

import numpy as np
import pytest
from tests.exam import physics
from tests.exam.cases import case

from diagnosis_logs import logs_of_case
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.projection import Projection
from ivsid.diagnosis.selection import dictionary
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.vehicle import parse_vehicle

HOW = {"kind": "twin", "style": "rich", "duration": 300.0, "rate": 10.0, "ambient": 1.0, "share": 0.5}
SEED, CABLE, INSIDE = 270003, 3.0, 20


def towed(log, length):
    """Angle of the cable off the stern, from ahead to starboard [rad], by times: the body moves towards the stern, as far as the cable asks for."""
    t, psi = log.t, log.columns["psi"]
    x, y = (log.columns[k] - 0.5 * length * f(psi) for k, f in (("x", np.cos), ("y", np.sin)))
    at = np.array([x[0] - CABLE * length * np.cos(psi[0]), y[0] - CABLE * length * np.sin(psi[0])])
    angle = []
    for k in range(t.size - 1):
        for q in np.arange(INSIDE) / INSIDE:
            stern = np.array([(1 - q) * x[k] + q * x[k + 1], (1 - q) * y[k] + q * y[k + 1]])
            pull = stern - at
            at = stern - pull * min(1.0, CABLE * length / np.hypot(*pull))
        towards = at - stern
        angle.append(np.arctan2(towards[1], towards[0]) - psi[k])
    return t[:-1], np.unwrap(np.array(angle))


def made(share=None):
    """A vehicle with its log, and with a tow whose pull has a share of the declared force as its rms."""
    patch = pytest.MonkeyPatch()
    try:
        c = case(SEED, what="none", **HOW)
        vehicle, log = parse_vehicle(c.text, "v.toml"), logs_of_case(c)[0]
        if share:
            t, angle = towed(log, vehicle.hull.length)
            size = share * vehicle.ambient.force / np.sqrt(np.mean(log.columns["u"] ** 4))

            def tow(_, at, u, psi, x, y):
                pull, towards = size * u * u, float(np.interp(at, t, angle))
                side = pull * np.sin(towards)
                return pull * np.cos(towards), side, -0.5 * vehicle.hull.length * side

            patch.setitem(physics.PLACE, "x.house", tow)
            log = logs_of_case(case(SEED, what="outside", effect="x.house", size=1.0, **HOW))[0]
    finally:
        patch.undo()
    return plain_fit(vehicle, channels(log, vehicle), everything)


def falls(fit):
    """Fall of chi-squared of each memory of the path beside the model, by name."""
    names, x, unit = dictionary.regressors(fit)
    g = fit.gram.only(fit.base)
    p = Projection(g.joined(names, x, unit), range(len(g.names)))
    return {n: p.solve([len(g.names) + k])[1] for k, n in enumerate(names) if n.endswith("trailing memory")}


def test_a_body_in_tow_is_told_by_the_path():
    fit = made(2.0)
    assert not adequacy(fit).white
    found = falls(fit)
    assert len(found) == 6 and max(found, key=found.get).startswith("yaw") and max(found.values()) > 100.0


def test_a_sound_log_has_none():
    fit = made()
    assert adequacy(fit).quiet and max(falls(fit).values()) < 20.0


def test_a_turn_fades_with_the_way():
    """The oracle steps through the turn a hundred times as finely, at a speed that varies."""
    h, length = 0.1, 2.0
    t = h * np.arange(400)
    speed, turn = 1.0 + 0.5 * np.sin(t), 0.3 * np.cos(0.7 * t)
    found = dictionary._fading(h * turn, np.exp(-h * speed / length))
    fine = np.linspace(0.0, t[-1], 100 * (t.size - 1) + 1)
    y, step = 0.0, fine[1]
    exact = []
    for s, r in zip(1.0 + 0.5 * np.sin(fine), 0.3 * np.cos(0.7 * fine), strict=True):
        exact.append(y)
        y += step * (r - s / length * y)
    assert found == pytest.approx(np.array(exact)[::100], abs=0.05)
