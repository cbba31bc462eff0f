"""A fit against another log."""

from dataclasses import replace

import numpy as np
import pytest

from conftest import as_log
from ivsid import IvsidError, identify, validate
from ivsid.effects import PAPER_TERMS, PLAIN_TERMS, terms_of
from ivsid.identification.constriction import constrict
from ivsid.rows import build_rows
from ivsid.sensors.bounds import bound_log
from ivsid.simulation import simulate
from ivsid.validation.dynamics import Dynamics
from ivsid.vehicle import parse_vehicle
from ivsid.workflow.first_screens import validated


@pytest.fixture(scope="module")
def other(swan, programme):
    return simulate(swan, programme.model_copy(update={"noise": "uniform"}), 99)


def test_a_right_model_is_not_contradicted(swan, twin, other):
    result = validate(identify(swan, as_log(twin)), as_log(other))
    assert [f.channel for f in result.forces] == ["surge", "sway", "yaw"]
    for force in result.forces:
        assert force.falsified == 0
        assert abs(force.mean) < 2.0
    assert result.motion.reason is None
    assert result.motion.rms["u"] < 0.05 and result.motion.window == {"velocity": 10.0}


def test_another_vehicle_is_contradicted(swan, twin, programme):
    truth = {"mass.surge": 120.0, "drag.surge.quadratic": 600.0, "inertia.yaw": 20.0}
    changed = simulate(swan, programme.model_copy(update={"noise": "uniform", "truth": truth}), 5)
    result = validate(identify(swan, as_log(twin)), as_log(changed))
    assert sum(f.falsified for f in result.forces) > 100
    # The next step names both logs, where their names tell them apart.
    apart = replace(result, fit=replace(result.fit, log_name="one.csv"), log_name="two.csv")
    assert "ivsid diagnose VEHICLE one.csv two.csv." in validated(apart).following[0]
    alike = replace(apart, log_name="one.csv")
    assert "ivsid diagnose VEHICLE LOG OTHER_LOG." in validated(alike).following[0]


def test_a_perfect_model_follows_velocities_and_position(swan, programme):
    from dataclasses import replace

    pose = "\n[sensors.heading]\naccuracy = 0.0\n[sensors.position]\naccuracy = 0.0\n"
    exact = parse_vehicle(swan.text.replace("absolute = 0.5", "absolute = 0.0") + pose, "exact.toml")
    made = simulate(exact, programme.model_copy(update={"noise": "none"}), 1)
    fit = replace(identify(swan, as_log(made)), estimate=made.truth["parameters"], vehicle=exact)
    motion = validate(fit, as_log(made)).motion
    assert motion.window == {"velocity": 10.0, "position": 30.0}
    assert motion.rms["u"] < 1e-5 and motion.rms["r"] < 1e-6
    assert motion.rms["position"] < 2e-3


def test_a_wrong_mass_shows_in_the_motion(swan, programme):
    from dataclasses import replace

    made = simulate(swan, programme.model_copy(update={"noise": "none"}), 1)
    fit = identify(swan, as_log(made))
    heavy = replace(fit, estimate={**fit.estimate, "mass.surge": 200.0})
    assert validate(heavy, as_log(made)).motion.rms["u"] > 3 * validate(fit, as_log(made)).motion.rms["u"]


def test_a_fit_without_parameters_is_refused(swan, twin, other):
    from dataclasses import replace

    fit = replace(identify(swan, as_log(twin)), estimate={}, parameters={})
    with pytest.raises(IvsidError, match="no parameter to validate"):
        validate(fit, as_log(other))


def test_terminal_speed_and_coasting_have_their_closed_forms():
    values = {
        "mass.surge": 50.0,
        "mass.sway": 60.0,
        "inertia.yaw": 5.0,
        "drag.surge.quadratic": 20.0,
        "drag.sway.quadratic": 80.0,
    }
    model = Dynamics(PLAIN_TERMS, values, 0.0, 0.0)
    nu = (0.0, 0.0, 0.0)
    for _ in range(4000):
        nu = model.step(nu, (45.0, 0.0, 0.0), 0.05)
    assert nu[0] == pytest.approx(1.5, rel=1e-9)
    # m udot = -d u^2 from u0: u = u0 / (1 + d u0 t / m)
    nu = (2.0, 0.0, 0.0)
    for _ in range(200):
        nu = model.step(nu, (0.0, 0.0, 0.0), 0.05)
    assert nu[0] == pytest.approx(2.0 / (1 + 20.0 * 2.0 * 10.0 / 50.0), rel=1e-7)


def test_coupled_masses_keep_the_energy():
    values = {
        "mass.surge": 50.0,
        "mass.sway": 80.0,
        "inertia.yaw": 9.0,
        "drag.surge.quadratic": 0.0,
        "drag.sway.quadratic": 0.0,
    }
    # Without drag, and with the moment that potential flow adds, the kinetic energy stays: C(nu) does no work.
    from ivsid.effects import CATALOGUE

    model = Dynamics((*PLAIN_TERMS, CATALOGUE["added_mass.munk"]), {**values, "added_mass.munk": 30.0}, 0.0, 0.0)
    nu = (1.0, 0.4, 0.3)

    def energy(nu):
        return 0.5 * (50.0 * nu[0] ** 2 + 80.0 * nu[1] ** 2 + 9.0 * nu[2] ** 2)

    start = energy(nu)
    for _ in range(400):
        nu = model.step(nu, (0.0, 0.0, 0.0), 0.02)
    assert energy(nu) == pytest.approx(start, rel=1e-6)


def test_singular_mass_matrices_are_refused():
    with pytest.raises(IvsidError, match="singular"):
        Dynamics(PAPER_TERMS, {"mass.surge": 0.0, "drag.surge.quadratic": 1.0, "inertia.yaw": 1.0}, 0.0, 0.0)
    with pytest.raises(IvsidError, match="no value is known for inertia.yaw"):
        Dynamics(PAPER_TERMS, {"mass.surge": 1.0, "drag.surge.quadratic": 1.0}, 0.0, 0.0)


def test_constriction_narrows_and_keeps_its_share(swan, twin):
    rows = build_rows(bound_log(as_log(twin), swan), swan, terms_of(swan))
    lower, upper = np.array([-100.0, 0.0, -20.0]), np.array([300.0, 800.0, 60.0])
    found = constrict(rows, lower, upper)
    assert found.steps > 3 and found.coverage >= 0.95
    assert (lower <= found.lower).all() and (found.upper <= upper).all()
    assert ((found.upper - found.lower) < (upper - lower)).all()
    with pytest.raises(IvsidError, match="unbounded"):
        constrict(rows, lower, np.array([np.inf, 1.0, 1.0]))


def test_validation_on_the_log_of_the_fit_says_so(swan, twin, other):
    own = replace(as_log(twin), sha256="a" * 64)
    fit = identify(swan, own)
    assert any("is the log that the fit was made of" in n for n in validate(fit, replace(own, name="copy.csv")).notes)
    assert not any("the fit was made of" in n for n in validate(fit, replace(as_log(other), sha256="b" * 64)).notes)
