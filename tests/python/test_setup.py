"""Wrong set-ups are named before anything is fitted, and sound logs have none. The faults are put in by ``setup_faults``, apart from the product."""

import numpy as np
import pytest
from tests.exam.cases import case

import ivsid
import setup_faults
from diagnosis_logs import vehicle_of
from ivsid import IvsidError, setup_findings, workflow
from ivsid.log import Log, read_log
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.report import page
from ivsid.setup.motion import motion
from ivsid.vehicle import parse_vehicle
from setup_faults import MOTION, drawn, named, pulses, thruster_faults

# Drawn vessels with turns: a twin, one with a rudder, an ROV with four thrusters, a tug with a bow thruster.
SEEDS = (7004, 7006, 7009, 7025)


def faulty(seed, change):
    text, t, columns = drawn(seed)
    return named(text, t, change(columns))


@pytest.mark.parametrize("fault", list(MOTION))
def test_faults_of_channels_are_named(fault):
    change, ids = MOTION[fault]
    for seed in SEEDS[:2]:
        found = faulty(seed, change)
        assert found and found[0] in ids, (seed, found)


@pytest.mark.parametrize("seed", SEEDS)
def test_faults_of_thrusters_are_named(seed):
    text, t, columns = drawn(seed)
    for fault, changed, ids in thruster_faults(columns):
        found = named(text, t, changed)
        assert found and found[0] in ids, (fault, found)


@pytest.mark.parametrize("seed", SEEDS)
def test_sound_logs_have_no_finding(seed):
    text, t, columns = drawn(seed)
    assert named(text, t, columns) == []
    assert named(text, t, setup_faults.bare(columns)) == []


# Nightly: five draws of one mechanism; the gate takes three.
@pytest.mark.parametrize(
    "seed", [8041, 8042, 8044, *(pytest.param(s, marks=pytest.mark.nightly) for s in (8040, 8043))]
)
def test_hidden_effects_are_no_set_up(seed):
    text, t, columns = drawn(seed, "one", None)
    assert named(text, t, columns) == []


@pytest.mark.nightly
def test_hidden_effects_are_no_set_up_in_many_cases():
    alarms = []
    for seed in range(30_000, 30_150):
        for what in ("none", "one"):
            made = case(seed, what=what, duration=300.0)
            for log in made.logs:
                columns = dict(log)
                if found := named(made.text, columns.pop("t"), columns):
                    alarms.append((seed, what, found))
    assert not alarms


@pytest.mark.nightly
def test_a_wrong_yaw_rate_is_named_in_every_one_of_100():
    for seed in range(100):
        made = case(40_000 + seed, what="none", style="rich", duration=200.0)
        columns = dict(made.logs[0])
        t = columns.pop("t")
        assert "setup.yaw_rate.sign" in named(made.text, t, setup_faults.times(r=-1)(columns)), seed


def test_what_a_log_cannot_show_is_not_claimed():
    text, t, columns = drawn(7001, style="line")
    swap = setup_faults.exchanged("demand_port", "demand_starboard")
    # Both thrusters push alike on a straight run.
    assert named(text, t, swap(columns)) == []


def test_a_thruster_that_failed_is_not_a_reversed_one():
    text, t, columns = drawn(7004)
    weak = text.replace('name = "port"', 'name = "port"\nreverse_factor = 1.0')
    half = {**columns, "demand_port": np.where(t > t[-1] / 2, -columns["demand_port"], columns["demand_port"])}
    # Reversed half of the time, it pushes nothing on average: it is neither sound nor reversed.
    assert "setup.thruster.reversed" not in named(weak, t, half)


@pytest.mark.parametrize("seed", range(6))
def test_two_sides_of_noise_contradict_nothing(seed):
    """A run of 250 m on one heading: its ways to starboard are 0.2 m, and a position is known to 0.5. A heading of other units gave both sides 5 m."""
    vehicle, rng = vehicle_of(), np.random.default_rng(seed)
    t = np.arange(0.0, 300.0, 0.1)
    r = sum(rng.normal(0, 0.004) * np.sin(2 * np.pi * t / k + rng.uniform(0, 6)) for k in (7.0, 13.0, 31.0))
    psi, u = np.cumsum(r) * 0.1, 0.8 + 0.2 * np.sin(t / 20)
    v = 0.003 * np.sin(t / 3)
    x = np.cumsum(u * np.cos(psi) - v * np.sin(psi)) * 0.1 + rng.normal(0, 0.15, t.size)
    y = np.cumsum(u * np.sin(psi) + v * np.cos(psi)) * 0.1 + rng.normal(0, 0.15, t.size)
    psi = psi + rng.normal(0, 0.0045, t.size)
    log = Log(
        "a.csv", "0" * 64, t, {"u": u, "v": v, "r": r + rng.normal(0, 0.0055, t.size), "psi": psi, "x": x, "y": y}
    )
    assert motion(vehicle, log).findings == ()


def test_one_fault_after_the_other():
    text, t, columns = drawn(7004)
    both = setup_faults.times(r=setup_faults.DEGREES, ax=1 / 9.80665, ay=1 / 9.80665)(columns)
    assert set(named(text, t, both)) == {"setup.yaw_rate.unit", "setup.acceleration.unit"}
    swapped = setup_faults.exchanged("demand_port", "demand_starboard")(setup_faults.times(r=-1)(columns))
    assert named(text, t, swapped) == ["setup.yaw_rate.sign", "setup.thruster.swapped"]


def test_the_remedy_mends_the_log():
    """The line of [log.columns] that a finding names, put into the vehicle file, leaves nothing to find."""
    text, t, columns = drawn(7004)
    for change in (setup_faults.times(r=-1), setup_faults.compass, setup_faults.exchanged("u", "v")):
        found = setup_findings(parse_vehicle(text, "v.toml"), {"t": t, **change(columns)})
        lines = found[0].remedy.removeprefix("state ").removesuffix(" under [log.columns]")
        lines = lines.replace(', v = "u"', '\nv = "u"')
        assert (
            setup_findings(parse_vehicle(f"{text}\n[log.columns]\n{lines}\n", "v.toml"), {"t": t, **change(columns)})
            == ()
        )


def test_a_remedy_counts_on_from_the_map_of_the_file():
    text, t, columns = drawn(7004)
    mapped = parse_vehicle(f'{text}\n[log.columns]\nr = {{ from = "gyro", scale = 2.0 }}\n', "v.toml")
    table = {"t": t, **{k: x for k, x in columns.items() if k != "r"}, "gyro": -columns["r"] / 2}
    (found,) = setup_findings(mapped, table)
    assert found.remedy == 'state r = { from = "gyro", scale = -2 } under [log.columns]'


THRUSTER = 'name = "b"\n[hull]\nmass = 1\n[[thrusters]]\nname = "p"\n'
UNIT = THRUSTER + "table = { demand = [-1, 0, 1], thrust = [-30, 0, 40] }\n"
WIDTHS = "table = { demand = [1100, 1500, 1900], thrust = [-30, 0, 40] }\n"


@pytest.mark.parametrize(
    ("text", "demands", "words"),
    [
        (
            UNIT,
            [1100.0, 1500.0, 1900.0],
            ["its missing neutral", "state neutral = 1500", "scale = 0.0025, offset = -3.75"],
        ),
        (
            THRUSTER + "gain = 0.1\ndemand_range = [-400, 400]\n",
            [1480.0, 1600.0],
            ["its missing neutral", "state neutral = 1500", "the demand_range as distances from it"],
        ),
        (
            THRUSTER + "neutral = 1500\n" + WIDTHS,
            [1100.0, 1500.0],
            ["pulse widths already", "leave neutral of thruster p out"],
        ),
        (THRUSTER + WIDTHS, [-0.5, 0.0, 1.0], ["these are fractions", "scale = 400, offset = 1500"]),
        (
            THRUSTER + "neutral = 1500\ngain = 0.1\ndemand_range = [-400, 400]\n",
            [-0.5, 1.0],
            ["these are fractions", "scale = 400, offset = 1500"],
        ),
    ],
)
def test_demands_in_another_unit_point_at_the_neutral(text, demands, words):
    for curve in (text, text.replace('name = "p"', 'name = "p"\noutside = "hold"')):
        vehicle = parse_vehicle(curve, "b.toml")
        if "hold" not in curve:
            with pytest.raises(IvsidError) as refusal:
                ThrustCurve(vehicle.thrusters[0]).value(np.array(demands))
            assert all(w in str(refusal.value) for w in words), str(refusal.value)
            assert 'outside = "hold"' not in str(refusal.value)
        log = Log("log.csv", "", np.arange(float(len(demands))), {"demand_p": np.array(demands)})
        (found,) = setup_findings(vehicle, log)
        assert found.id == "setup.demand.unit" and found.certain
        assert all(w in found.line for w in words)


def test_a_gain_without_ends_is_reported_and_refuses_nothing():
    for demands, count in (([1100.0, 1500.0, 1900.0], 1), ([0.0, 1500.0], 0), ([-1.0, 1.0], 0), ([1100.0, 2500.0], 0)):
        log = Log("log.csv", "", np.arange(float(len(demands))), {"demand_p": np.array(demands)})
        found = setup_findings(parse_vehicle(THRUSTER + "gain = 0.1\n", "b.toml"), log)
        assert len(found) == count
        assert all(not f.certain and "state neutral = 1500" in f.remedy for f in found)


def test_the_neutral_that_is_named_serves():
    for text in (UNIT.replace("-1, 0, 1", "-400, 0, 400").replace('"p"', '"p"\nneutral = 1500'), THRUSTER + WIDTHS):
        thrust = ThrustCurve(parse_vehicle(text, "b.toml").thrusters[0]).value([1100.0, 1500.0, 1900.0])
        assert thrust == pytest.approx([-30, 0, 40])


def test_demands_beyond_a_curve_of_the_same_unit_keep_their_sentence():
    vehicle = parse_vehicle(UNIT, "b.toml")
    with pytest.raises(
        IvsidError, match=r'lies outside its table \(-1 to 1\); extend the table, or set outside = "hold"'
    ):
        ThrustCurve(vehicle.thrusters[0]).value(np.array([0.0, 1.5]))
    for demands in ([0.0, 1.5], [1200.0, 5.0], [0.1, 0.2]):
        log = Log("log.csv", "", np.arange(float(len(demands))), {"demand_p": np.array(demands)})
        assert setup_findings(vehicle, log) == ()


def test_pulse_widths_are_named_where_the_curve_holds_its_ends():
    text, t, columns = drawn(7004)
    text, columns = pulses(text, columns, hold=True)
    assert named(text, t, columns)[0] == "setup.demand.unit"


def test_a_rate_beyond_the_limits_is_named_by_them_alone():
    text, t, columns = drawn(7004)
    wild = {**setup_faults.bare(columns), "r": 18.0 * np.sin(2 * np.pi * t / 4)}
    (found,) = setup_findings(parse_vehicle(text, "v.toml"), Log("log.csv", "", t, wild))
    assert found.id == "setup.r.limit" and found.certain
    assert "against [sensors.limits] yaw_acceleration = 3" in found.sentence and 'unit = "deg/s"' in found.remedy
    # One glimpse of something else is no unit.
    one = {**setup_faults.bare(columns), "r": np.where(np.abs(t - 100) < 0.05, 18.0, columns["r"])}
    assert "setup.r.limit" not in named(text, t, one)


@pytest.mark.parametrize("name", ["otter", "vectored_rov"])
def test_built_in_vehicles_are_sound(name):
    from conftest import embedded
    from ivsid.programme.scenario import parse_scenario
    from ivsid.simulation import simulate

    text = embedded(f"{name}.toml")
    ambient = "\n[ambient]\nforce = 2.0\nmoment = 0.5\ntime = 2.0\n"
    vehicle = parse_vehicle(text if "[ambient]" in text else text + ambient, name)
    scenario = parse_scenario(embedded(f"{name}_programme.toml"), name)
    made = simulate(vehicle, scenario.model_copy(update={"duration": 150.0}), 3)
    log = Log("twin.csv", "", made.t, made.columns)
    assert setup_findings(vehicle, log) == ()
    turned = Log("twin.csv", "", made.t, {**made.columns, "r": -made.columns["r"]})
    assert "setup.yaw_rate.sign" in [f.id for f in setup_findings(vehicle, turned)]


# Nightly: the gate names the faults of simulated channels.
@pytest.mark.nightly
def test_real_logs_are_sound_and_their_faults_are_named(real, tmp_path):
    page.write(workflow.import_set("rov30k", real("rov_30k")), tmp_path / "rov")
    page.write(workflow.import_set("cse1", real("cse1")), tmp_path / "cse")
    otter = __import__("pathlib").Path(__file__).parents[2] / "examples" / "otter.toml"
    pairs = [
        *((tmp_path / "rov" / "rov30k.toml", tmp_path / "rov" / f"{n}.csv") for n in ("manual", "automatic")),
        *(
            (tmp_path / "cse" / "cse1.toml", tmp_path / "cse" / f"{n}.csv")
            for n in ("run1", "random_run1", "random_run3")
        ),
        *((otter, real(f"sim_truth_pvs/otter_{n}.csv.gz")) for n in ("calm", "current_0p4_30deg")),
    ]
    for vehicle, log in pairs:
        assert setup_findings(vehicle, log) == (), log
    vehicle = ivsid.read_vehicle(pairs[0][0])
    log = read_log(pairs[0][1], vehicle.log)
    table = {"t": log.t, **log.columns}
    for change, id_ in (
        (setup_faults.times(r=-1), "setup.yaw_rate.sign"),
        (setup_faults.times(r=setup_faults.DEGREES), "setup.yaw_rate.unit"),
        (setup_faults.exchanged("u", "v"), "setup.velocity.axes"),
        (setup_faults.times(u=setup_faults.KNOTS, v=setup_faults.KNOTS), "setup.velocity.unit"),
        (setup_faults.exchanged("demand_port", "demand_starboard"), "setup.thruster.swapped"),
        (setup_faults.times(demand_port=-1), "setup.thruster.reversed"),
    ):
        assert id_ in [f.id for f in setup_findings(vehicle, change(table))], id_
