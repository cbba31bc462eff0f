"""The simulator against closed forms, conserved quantities, its own halved step, and a third party's simulator."""

import numpy as np
import polars as pl
import pytest

from ivsid import IvsidError
from ivsid.effects import CATALOGUE, EFFECTS, sort_given, terms_of
from ivsid.programme.scenario import Faults, Sensing, Start, parse_scenario
from ivsid.simulation import follow, simulate
from ivsid.simulation.equations import equations, plant
from ivsid.vehicle import parse_vehicle
from sampling import spaced

BOAT = """
name = "boat"
[hull]
mass = 50
length = 1.2
[[thrusters]]
name = "port"
position = [-0.4, -0.28]
gain = 1.0
[[thrusters]]
name = "starboard"
position = [-0.4, 0.28]
gain = 1.0
"""
TRUTH = {
    "mass.surge": 58.0,
    "mass.sway": 75.0,
    "inertia.yaw": 9.0,
    "drag.surge.quadratic": 28.0,
    "drag.sway.quadratic": 150.0,
}


def boat(extra="", edit=("", "")):
    return parse_vehicle(BOAT.replace(*edit) + extra, "boat.toml")


def move(seconds, rate=20.0, demand=(0.0, 0.0), start=None, vehicle=None, **values):
    """A motion under constant demands, with ids in the keys' spelling a__b for a.b."""
    t = np.arange(round(seconds * rate) + 1) / rate
    demands = {
        n: np.full(t.size, q) if np.isscalar(q) else q for n, q in zip(("port", "starboard"), demand, strict=True)
    }
    truth = {**TRUTH, **{k.replace("__", "."): v for k, v in values.items()}}
    return t, follow(vehicle or boat(), truth, t, demands, Start(**(start or {})))


def test_coasting_and_terminal_speed_have_their_closed_forms():
    t, free = move(30, start={"u": 2.0})
    np.testing.assert_allclose(free["u"], 2 / (1 + 28 * 2 * t / 58), rtol=1e-6)
    np.testing.assert_allclose(free["x"], 58 / 28 * np.log1p(28 * 2 * t / 58), rtol=1e-6, atol=1e-6)
    t, linear = move(30, start={"u": 2.0}, drag__surge__quadratic=0.0, drag__surge__linear=4.0)
    np.testing.assert_allclose(linear["u"], 2 * np.exp(-4 * t / 58), rtol=1e-8)
    t, driven = move(120, demand=(31.5, 31.5))
    np.testing.assert_allclose(driven["u"], 1.5 * np.tanh(t * np.sqrt(63 * 28) / 58), atol=1e-6)
    assert driven["u"][-1] == pytest.approx(1.5, rel=1e-9)
    t, dry = move(20, start={"u": 1.0}, drag__surge__quadratic=0.0, friction__coulomb=2.0)
    moving = dry["u"] > 0.1
    np.testing.assert_allclose(dry["u"][moving], 1 - 2 * t[moving] / 58, atol=2e-5)
    t, turning = move(20, start={"r": 0.5}, drag__yaw__linear=1.0)
    np.testing.assert_allclose(turning["psi"], 0.5 * 9 * (1 - np.exp(-t / 9)), rtol=1e-7, atol=1e-9)
    t, braked = move(20, start={"u": -1.0}, drag__surge__quadratic=0.0, drag__surge__astern=10.0)
    np.testing.assert_allclose(braked["u"], -1 / (1 + 10 * t / 58), rtol=1e-6)


def test_energy_is_the_work_of_what_pushes():
    """Kinetic energy of M (with Munk's moment and the offset centre of gravity) changes by the power of drag and thrust alone."""
    vehicle = boat(edit=("mass = 50\n", "mass = 50\ncentre_of_gravity = [0.05, -0.02]\n"))
    start = {"u": 1.0, "v": 0.4, "r": 0.3}
    still = {"drag__surge__quadratic": 0.0, "drag__sway__quadratic": 0.0, "added_mass__munk": 17.0}
    mx, my = 50 * 0.05, 50 * -0.02
    M = np.array([[58.0, 0, -my], [0, 75.0, mx], [-my, mx, 9.0]])

    def energy(m):
        nu = np.stack([m[n] for n in ("u", "v", "r")])
        return 0.5 * np.einsum("it,ij,jt->t", nu, M, nu)

    _, free = move(60, start=start, vehicle=vehicle, **still)
    np.testing.assert_allclose(energy(free), energy(free)[0], rtol=1e-6)
    # With drag, cross-flow and thrust: the change is the integral of their power, which a fine trapezoid gives.
    damped = {"drag__cross_flow": 20.0, "drag__yaw__linear": 1.0, "drag__surge__linear": 3.0, "added_mass__munk": 17.0}
    t, m = move(5, rate=400, start=start, vehicle=vehicle, demand=(20.0, 12.0), **damped)
    x = np.linspace(-0.6, 0.6, 3201)[:, None]
    across = m["v"] + x * m["r"]
    power = (
        32 * m["u"] + 0.28 * 8 * m["r"] - 28 * abs(m["u"]) ** 3 - 150 * abs(m["v"]) ** 3 - 3 * m["u"] ** 2 - m["r"] ** 2
    )
    power = power - 20 * np.trapezoid(np.abs(across) ** 3, x[:, 0], axis=0)
    work = np.r_[0, np.cumsum(np.diff(t) * (power[1:] + power[:-1]) / 2)]
    np.testing.assert_allclose(energy(m) - energy(m)[0], work, atol=5e-5)


def test_a_current_carries_the_vehicle_and_changes_nothing_else():
    """In a steady current the motion through the water is that of calm water, carried along (Galilei)."""
    calm = {"demand": (20.0, 12.0), "start": {"u": 0.5, "v": 0.1, "r": 0.1, "psi": 0.3}, "drag__yaw__linear": 3.0}
    t, still = move(60, **calm)
    c, s = np.cos(0.3), np.sin(0.3)
    moving = {**calm, "start": {**calm["start"], "u": 0.5 + 0.2 * c - 0.1 * s, "v": 0.1 - 0.2 * s - 0.1 * c}}
    _, carried = move(60, **moving, current__steady__north=0.2, current__steady__east=-0.1)
    np.testing.assert_allclose(carried["psi"], still["psi"], atol=1e-5)
    np.testing.assert_allclose(carried["x"], still["x"] + 0.2 * t, atol=1e-4)
    np.testing.assert_allclose(carried["y"], still["y"] - 0.1 * t, atol=1e-4)


def test_an_oscillating_current_drags_the_hull_by_its_added_mass_alone():
    """Without drag: M_RB udot = -M_A (udot - Vdot), so u = V(t) M_A / (M_RB + M_A)."""
    still = {"drag__surge__quadratic": 0.0, "drag__sway__quadratic": 0.0}
    current = {
        f"current__oscillating__{k}": v for k, v in (("north", 0.3), ("east", 0.0), ("period", 20.0), ("phase", 0.0))
    }
    t, m = move(40, **still, **current)
    np.testing.assert_allclose(m["u"], 0.3 * np.sin(2 * np.pi * t / 20) * 8 / 58, atol=1e-6)


def test_forces_of_the_environment():
    still = {"drag__surge__quadratic": 0.0, "drag__sway__quadratic": 0.0}
    east = {"start": {"psi": np.pi / 2}}
    _, wind = move(10, **still, **east, wind__steady__north=3.0, wind__steady__east=5.8)
    assert wind["udot"][0] == pytest.approx(5.8 / 58) and wind["vdot"][0] == pytest.approx(-3.0 / 75)
    wave = {
        f"wave__force__{k}": v for k, v in (("amplitude", 2.0), ("period", 4.0), ("phase", 0.7), ("direction", 0.0))
    }
    t, m = move(10, **still, **wave)
    np.testing.assert_allclose(m["udot"], 2 * np.sin(2 * np.pi * t / 4 + 0.7) / 58, atol=1e-9)
    # A tether pulls to its anchor: potential energy force times distance is conserved with the motion.
    tether = {
        f"tether__tension__{k}": v
        for k, v in (("force", 1.5), ("anchor_north", 5.0), ("anchor_east", 2.0), ("arm", 0.0))
    }
    _, m = move(20, **still, **tether, mass__sway=58.0, start={"v": 0.2})
    energy = 29 * (m["u"] ** 2 + m["v"] ** 2) + 1.5 * np.hypot(5 - m["x"], 2 - m["y"])
    np.testing.assert_allclose(energy, energy[0], atol=2e-3)
    _, armed = move(1, **still, **{**tether, "tether__tension__arm": -0.5})
    assert armed["rdot"][0] == pytest.approx(-0.5 * 1.5 * 2 / np.hypot(5, 2) / 9, rel=1e-4)
    t, fouled = move(300, demand=(10.0, 10.0), fouling__drift=2e-3)
    assert fouled["u"][-1] == pytest.approx(np.sqrt(20 / (28 * 1.6)), rel=2e-2)
    _, shallow = move(1, demand=(10.0, 10.0), environment__shallow_water=1.25)
    assert shallow["udot"][0] == pytest.approx(20 / (58 * 1.25))


def test_a_payload_comes_at_its_time_between_two_samples():
    t, m = move(
        10, rate=4.0, demand=(10.0, 10.0), drag__surge__quadratic=0.0, payload__step__mass=10.0, payload__step__time=3.1
    )
    expected = np.where(t <= 3.1, 20 * t / 58, 20 * 3.1 / 58 + 20 * (t - 3.1) / 68)
    np.testing.assert_allclose(m["u"], expected, rtol=1e-9)


def test_wind_blows_from_its_direction_on_the_moving_vehicle():
    scenario = parse_scenario(
        'duration = 5\nrate = 10\nnoise = "none"\n[truth]\n'
        + "".join(f'"{k}" = {v}\n' for k, v in TRUTH.items())
        + '"wind.steady.surge" = 0.02\n"wind.steady.sway" = 0.05\n[environment]\nwind_speed = 8\nwind_direction = 0.0\n'
        '[start]\nu = 1.0\n[[segments]]\nmanoeuvre = "free_decay"\n',
        "wind.toml",
    )
    made = simulate(boat(), scenario)
    # From the north onto a bow that runs at 1 m/s: 9 m/s of apparent wind push astern.
    assert made.exact["udot"][0] == pytest.approx((-28 - 0.02 * 81) / 58)
    assert set(made.columns) == {"demand_port", "demand_starboard", "wind_speed", "wind_direction"}
    with pytest.raises(IvsidError, match="multiplies the wind"):
        simulate(boat(), scenario.model_copy(update={"environment": type(scenario.environment)()}))


def test_halving_the_step_moves_nothing_that_matters(swan, programme):
    made = simulate(swan, programme, 3)
    error = made.truth["integration"]["error"]
    assert max(error.values()) < 1e-5
    coarse = simulate(swan, programme.model_copy(update={"rate": 10.0}), 3)
    assert coarse.truth["integration"]["steps_per_sample"] >= 2
    stiff = {**programme.truth, "drag.surge.linear": 3e5}
    settled = simulate(swan, programme.model_copy(update={"truth": stiff, "rate": 200.0, "duration": 5.0}), 3)
    assert np.abs(settled.exact["u"]).max() < 1e-3
    with pytest.raises(IvsidError, match="does not settle|without bound"):
        simulate(swan, programme.model_copy(update={"truth": {**stiff, "drag.surge.linear": 3e9}}), 3)


def test_ten_minutes_at_20_hz_take_about_a_second(swan, programme):
    import time

    start = time.process_time()
    simulate(swan, programme.model_copy(update={"duration": 600.0}), 1)
    # One second is the aim (benches/simulation.py); a machine that is busy with more gets three.
    assert time.process_time() - start < 3.0


def runge_kutta(rates, t, h, state, tails, inside):
    """The classical method by hand, with what follows the state at the start, the middle and the end of the step."""
    first, middle, last = tails

    def moved(share, k):
        return [q + share * r for q, r in zip(state, k, strict=True)]

    a = rates(t + inside * h, *state, *first)
    b = rates(t + 0.5 * h, *moved(0.5 * h, a), *middle)
    c = rates(t + 0.5 * h, *moved(0.5 * h, b), *middle)
    d = rates(t + h - inside * h, *moved(h, c), *last)
    return tuple(q + h / 6.0 * (w + 2.0 * (x + y) + z) for q, w, x, y, z in zip(state, a, b, c, d, strict=True))


@pytest.mark.parametrize("turning", [False, True])
def test_a_step_that_is_written_out_is_the_method_to_the_bit(swan, programme, turning):
    """Steady and varied steps; operations whose operands did not change within the step are not done again."""
    from ivsid.simulation.equations import equations, plant, steps
    from ivsid.simulation.propulsion import INSIDE

    effects = {
        "drag.cross_flow": 20.0,
        "current.steady.north": 0.1,
        "current.steady.east": 0.2,
        "thruster.advance_loss": 0.05,
    }
    if turning:
        effects |= {
            "wave.force.amplitude": 2.0,
            "wave.force.period": 4.0,
            "payload.step.mass": 3.0,
            "payload.step.time": 5.0,
        }
        effects |= {f"wave.force.{p}": 0.3 for p in ("phase", "direction")}
    model = plant(swan, terms_of(swan), sort_given({**programme.truth, **effects}))
    rates, made = equations(model), steps(model, INSIDE)
    rng = np.random.default_rng(0)
    for _ in range(50):
        t, h, state = rng.uniform(0, 10), rng.uniform(0.001, 0.1), rng.uniform(-2, 2, 6).tolist()
        fixed, angles = rng.uniform(-5, 5, 5).tolist(), rng.uniform(-1, 1, 2).tolist()
        thrusts = rng.uniform(-20, 20, (3, 2)).tolist()
        held = (*fixed, *thrusts[0], *angles)
        assert made.steady(t, h, *state, *made.held(*held)) == runge_kutta(rates, t, h, state, (held,) * 3, INSIDE)
        tails = [(*fixed, *q, *angles) for q in thrusts]
        varied = made.varied(t, h, *state, *fixed, *angles, *thrusts[0], *thrusts[1], *thrusts[2])
        assert varied == runge_kutta(rates, t, h, state, tails, INSIDE)


def test_a_coarse_run_that_ends_early_changes_nothing(swan, programme):
    """The first run is only looked at until it is too far off; what is accepted, and its error, are those of whole runs."""
    from ivsid.simulation.equations import equations, plant, steps
    from ivsid.simulation.integrate import TOLERANCE, run, settle
    from ivsid.simulation.propulsion import INSIDE, Propulsion
    from ivsid.simulation.true_thrust import TrueThrust

    # A quick heave of the moment: one step a sample is too coarse.
    model = plant(swan, terms_of(swan), sort_given({**programme.truth, "drag.yaw.linear": 150.0}))
    times, outside = (np.arange(200) / 20).tolist(), np.zeros((200, 5))
    outside[:, 2] = 30 * np.sign(np.sin(np.arange(200)))
    parts = equations(model), steps(model, INSIDE)

    def make():
        curves = [TrueThrust(t, np.random.default_rng(0)) for t in swan.thrusters]
        return Propulsion(model, curves), lambda _k, _state: ([30.0, 40.0], [0.0, 0.0])

    start = (0.0,) * 6
    path = settle(*parts, make, times, start, outside)
    whole = {n: run(*parts, *make(), times, start, outside, n) for n in (path.steps // 2, path.steps)}
    assert path.steps > 2 and path.states.tobytes() == whole[path.steps].states.tobytes()
    moved = np.abs(whole[path.steps].states[:, :3] - whole[path.steps // 2].states[:, :3]).max(axis=0) / 15
    assert path.error == tuple(moved.tolist())
    assert (moved <= np.maximum(TOLERANCE * np.abs(path.states[:, :3]).max(axis=0), 1e-9)).all()
    near = run(*parts, *make(), times, start, outside, 1, (path.states, np.full(3, 1e-7)))
    assert 0 < len(near.states) < 200


def test_floats_and_arrays_compile_to_the_same_motion(swan):
    truth = {"mass.surge": 60.0, "drag.surge.quadratic": 200.0, "inertia.yaw": 8.0}
    further = {"drag.cross_flow": 20.0, "friction.coulomb": 1.0, "drag.surge.astern": 5.0, "payload.step.mass": 3.0}
    wave = {"wave.force.amplitude": 1.0, "wave.force.period": 3.0, "wave.force.phase": 0.1, "wave.force.direction": 0.4}
    current = {
        "current.steady.north": 0.1,
        "current.steady.east": 0.2,
        "payload.step.time": 5.0,
        "added_mass.munk": 4.0,
    }
    given = sort_given({**truth, **further, **wave, **current})
    model = plant(swan, terms_of(swan), given)
    one, many = equations(model), equations(model, arrays=True)
    rng = np.random.default_rng(1)
    arguments = rng.uniform(-1, 1, (16, 40))
    arguments[0] = rng.uniform(0, 10, 40)
    together = np.stack(many(*arguments))
    for k in range(40):
        np.testing.assert_allclose(one(*map(float, arguments[:, k])), together[:, k], rtol=1e-12, atol=1e-12)


def test_the_catalogue_moves_as_the_dynamics_of_a_fit_does(swan, programme):
    """Two ways from the same columns: the compiled equations and the model that validates a fit."""
    from ivsid.validation.dynamics import Dynamics

    linear = [i for i in CATALOGUE if i != "drag.cross_flow"]
    text = swan.text.replace('terms = "paper"', f"terms = {linear}")
    vehicle = parse_vehicle(text, "all.toml")
    values = {i: 0.7 * abs(EFFECTS[i].parameters[0].typical) for i in linear}
    made = simulate(vehicle, programme.model_copy(update={"truth": values, "duration": 20.0}), 2)
    mass, (x_g, y_g) = vehicle.hull.mass, vehicle.hull.centre_of_gravity
    model = Dynamics(terms_of(vehicle), values, mass * x_g, mass * y_g)
    e, thrust = made.exact, np.zeros((made.t.size, 3))
    for name, y in (("port", -0.3), ("starboard", 0.3)):
        from ivsid.simulation.true_thrust import TrueThrust

        curve = TrueThrust(vehicle.thrusters[0 if name == "port" else 1], np.random.default_rng(0))
        curve.__dict__.update(made.truth["thrust_error"][name])
        force = np.array([curve(float(d)) for d in made.columns[f"demand_{name}"]])
        thrust += np.outer(force, [1.0, 0.0, -y])
    rates = model.acceleration((e["u"], e["v"], e["r"]), tuple(thrust.T))
    for name, rate in zip(("udot", "vdot", "rdot"), rates, strict=True):
        np.testing.assert_allclose(e[name], rate, atol=1e-9)


# --- a third party's simulator ---------------------------------------------------------------------------------------------------

OTTER = """
name = "Otter"
[hull]
mass = 80
length = 2.0
centre_of_gravity = [0.153125, 0]
"""
PROPELLER = "[[thrusters]]\nname = '{}'\nposition = [0, {}]\nquadratic = {{ forward = 0.01108, reverse = 0.006445 }}\n"
# truth.json: M, D, ten times D[5][5] as quadratic damping, Munk's moment m_v - m_u; the cross-flow coefficient was fitted to its
# accelerations (100.4 kg/m^2 in sway and in yaw alike).
OTTER_TRUTH = {
    "mass.surge": 85.5,
    "mass.sway": 162.5,
    "inertia.yaw": 42.65145,
    "drag.surge.quadratic": 0.0,
    "drag.sway.quadratic": 0.0,
    "drag.surge.linear": 77.55443,
    "drag.sway.linear": 162.5,
    "drag.yaw.linear": 42.65145,
    "drag.yaw.quadratic": 426.5145,
    "added_mass.munk": 77.0,
    "drag.cross_flow": 100.4,
}


@pytest.mark.parametrize(
    ("name", "current", "limits"),
    [
        # Rms over 600 s in open loop, as shares of the rms of the channel itself.
        # Nightly: the other log has the same vessel in a current.
        pytest.param("otter_calm", None, (0.005, 0.06, 0.02), marks=pytest.mark.nightly),
        ("otter_current_0p4_30deg", (0.4 * np.cos(np.pi / 6), 0.4 * np.sin(np.pi / 6)), (0.02, 0.06, 0.02)),
    ],
)
@pytest.mark.sampled
def test_otter_of_a_third_party(real, name, current, limits):
    """600 s in open loop from rest.

    What its six degrees of freedom have and three cannot: heave and pitch push in surge. They are given as a known force from the
    logged heave and pitch (its payload of 25 kg makes weight exceed the modelled buoyancy, hence 25 g sin theta). Propeller speeds are
    the logged states, between rows on a straight line.
    """
    frame = pl.read_csv(real(f"sim_truth_pvs/{name}.csv.gz"))
    log = {c: frame[c].to_numpy() for c in frame.columns}
    t, fine = log["t_s"], 5
    at = np.linspace(0, t[-1], (t.size - 1) * fine + 1)
    middle = at + 0.5 * at[1]

    def between(column):
        return np.interp(middle, t, log[column])

    w, p, q, r = (between(c) for c in "wpqr")
    heave = 19.75 * between("qdot") - 135 * w * q + 12.25 * q * q + 19.75 * p * r - 25 * 9.81 * between("theta")
    force = np.stack([heave, 0 * heave, 0 * heave], axis=1)
    vehicle = parse_vehicle(OTTER + PROPELLER.format("left", -0.395) + PROPELLER.format("right", 0.395), "otter.toml")
    values = dict(OTTER_TRUTH)
    if current:
        values |= {"current.steady.north": current[0], "current.steady.east": current[1]}
    demands = {n: between(f"n_{n}_radps_act") for n in ("left", "right")}
    made = follow(vehicle, values, at, demands, force=force)
    for channel, limit in zip("uvr", limits, strict=True):
        error = made[channel][::fine] - log[channel]
        assert np.sqrt(np.mean(error**2)) < limit * np.sqrt(np.mean(log[channel] ** 2)), channel
    # A model without cross-flow, Munk's moment or in calm water is told from the right one.
    wrong_ones = (
        {"drag.cross_flow": 0.0},
        {"added_mass.munk": 0.0},
        {"current.steady.north": 0.0} if current else {"drag.sway.linear": 80.0},
    )
    for wrong in spaced(wrong_ones, 2):
        other = follow(vehicle, {**values, **wrong}, at, demands, force=force)
        worse = np.sqrt(np.mean((other["v"][::fine] - log["v"]) ** 2))
        assert worse > 2 * np.sqrt(np.mean((made["v"][::fine] - log["v"]) ** 2)), wrong


@pytest.mark.parametrize(
    "effects", [{"coupling.cg_x": 1e9}, {"payload.step.mass": -200.0, "payload.step.time": 1.0}, {"mass.surge": -5.0}]
)
def test_a_mass_matrix_that_is_not_positive_definite_is_refused(swan, programme, effects):
    short = programme.model_copy(update={"duration": 3.0})
    with pytest.raises(IvsidError, match="mass matrix of the model is not positive definite"):
        simulate(swan, short, 1, effects)


def test_a_sensor_slower_than_the_log_is_long_gives_one_reading(swan, programme):
    scenario = programme.model_copy(update={"duration": 3.0, "sensing": Sensing(velocity=Faults(period=1e300))})
    assert np.unique(simulate(swan, scenario, 1).columns["u"]).size == 1


def test_a_vehicle_without_thrusters_follows_its_known_forces():
    """A constant force along the keel against a linear drag: the speed rises to force over drag by the hull's time constant."""
    text = 'name = "towed"\n[hull]\nmass = 40.0\nlength = 1.5\n[model]\nterms = ["mass.surge", "mass.sway", "inertia.yaw", "drag.surge.linear"]\n'
    values = {"mass.surge": 50.0, "mass.sway": 60.0, "inertia.yaw": 8.0, "drag.surge.linear": 10.0}
    t = np.arange(0.0, 20.0, 0.1)
    force = np.tile([5.0, 0.0, 0.0], (t.size, 1))
    moved = follow(parse_vehicle(text, "towed.toml"), values, t, {}, force=force)
    np.testing.assert_allclose(moved["u"], 0.5 * -np.expm1(-t / 5.0), atol=1e-6)
    assert not moved["thrust"].any() and not moved["r"].any()
