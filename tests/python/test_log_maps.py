"""Column maps: names, scales, units, frames, attitude, earth-frame velocities; drawn at random and against independent libraries."""

import numpy as np
import polars as pl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ivsid import IvsidError, read_log
from ivsid.files import units
from ivsid.files.log_map import LogMap
from ivsid.log import COLUMNS
from ivsid.propulsion.thrust import ThrustCurve
from ivsid.sensors.bounds import bound_log
from ivsid.vehicle import parse_vehicle

N = 24
T = np.arange(N) * 0.25


def written(tmp_path, **columns):
    path = tmp_path / "log.csv"
    pl.DataFrame({"t": T, **columns}).write_csv(path)
    return path


names = st.text(
    st.characters(
        codec="utf-8", exclude_characters='\r\n\x00",;\t ', exclude_categories=("Cs", "Cc", "Zs", "Zl", "Zp")
    ),
    min_size=1,
    max_size=12,
)
numbers = st.floats(-1e3, 1e3, allow_nan=False)
MAPPABLE = [c for c in COLUMNS if c not in ("qw", "qx", "qy", "qz", "velocity_north", "velocity_east")]


@settings(max_examples=120, deadline=None)
@given(data=st.data())
def test_any_map_gives_the_scaled_column_or_one_sentence(tmp_path_factory, data):
    tmp_path = tmp_path_factory.mktemp("map")
    foreign = data.draw(
        st.lists(names.filter(lambda n: n not in ("t", *COLUMNS) and "/" not in n), min_size=1, max_size=5, unique=True)
    )
    values = {n: np.array(data.draw(st.lists(numbers, min_size=N, max_size=N))) for n in foreign}
    targets = data.draw(
        st.lists(st.sampled_from([*MAPPABLE, "demand_port", "speed"]), min_size=1, max_size=4, unique=True)
    )
    columns = {}
    for target in targets:
        columns[target] = {
            "from": data.draw(st.sampled_from([*foreign, "absent"])),
            "scale": data.draw(st.sampled_from([1.0, -1.0, 0.01, 3.7])),
            "offset": data.draw(st.sampled_from([0.0, -1500.0, 0.25])),
            "unit": data.draw(st.sampled_from([None, "deg/s", "kn", "mm", "kgf"])),
        }
    path = tmp_path / "log.csv"
    pl.DataFrame({"t": T, **values}).write_csv(path)
    mapping = LogMap.model_validate({"columns": columns})
    wrong = any(c["from"] == "absent" for c in columns.values()) or "speed" in columns
    if wrong:
        with pytest.raises(IvsidError) as caught:
            read_log(path, mapping)
        assert "\n" not in str(caught.value)
        return
    log = read_log(path, mapping)
    assert set(log.columns) == set(columns)
    assert set(log.ignored) == set(foreign) - {c["from"] for c in columns.values()}
    for target, rule in columns.items():
        factor = rule["scale"] * (units.COLUMN[rule["unit"]] if rule["unit"] else 1.0)
        got = log.columns[target]
        there = np.isfinite(got)
        expected = values[rule["from"]] * factor + rule["offset"]
        assert there.any()
        assert (np.abs(got - expected)[there] <= log.error(target)[there]).all()
        # A missing sample repeats the value before it: a held reading.
        for k in np.flatnonzero(~there):
            assert k > 0 and expected[k] == expected[k - 1]


def test_a_marker_for_missing_samples(tmp_path):
    u = np.sin(T)
    u[[3, 4, 9]] = -32.768
    mapping = LogMap.model_validate({"columns": {"u": {"from": "dvl", "missing": -32.768}}})
    log = read_log(written(tmp_path, dvl=u), mapping)
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(log.columns["u"])), [3, 4, 9])
    assert log.quality["u"].lower > -1.1


def test_ros_axes_turn_body_and_earth(tmp_path):
    """REP 103: x forward, y left, z up; earth east-north-up."""
    rng = np.random.default_rng(1)
    raw = {
        n: rng.standard_normal(N)
        for n in (
            "u",
            "v",
            "r",
            "ax",
            "ay",
            "x",
            "y",
            "psi",
            "force_Y",
            "demand_bow",
            "azimuth_bow",
            "velocity_north",
            "depth",
        )
    }
    scaled = LogMap.model_validate({"frame": "flu", "columns": {"x": {"from": "x", "scale": 1000.0}}})
    log = read_log(written(tmp_path, **raw), scaled)
    for same in ("u", "ax", "velocity_north", "depth"):
        np.testing.assert_array_equal(log.columns[same], raw[same])
    for flipped in ("v", "r", "ay", "force_Y", "azimuth_bow"):
        np.testing.assert_array_equal(log.columns[flipped], -raw[flipped])
    np.testing.assert_array_equal(log.columns["x"], raw["y"])
    np.testing.assert_array_equal(log.columns["y"], raw["x"] * 1000.0)
    # The rounding by the scale of the eastward column goes with that column.
    assert (log.error("y") > 3 * np.spacing(np.abs(log.columns["y"]))).all()
    assert "x" not in log.rounding
    assert (np.abs(log.columns["psi"] - (np.pi / 2 - raw["psi"])) <= log.error("psi")).all()


def test_one_earth_axis_alone_is_turned_too(tmp_path):
    log = read_log(written(tmp_path, x=np.sin(T)), LogMap.model_validate({"frame": "flu"}))
    assert list(log.columns) == ["y"]


@pytest.mark.parametrize("frame", ["frd", "flu"])
def test_heading_from_attitude_against_scipy(tmp_path, frame):
    rng = np.random.default_rng(2)
    yaw, pitch, roll = rng.uniform(-3, 3, N), rng.uniform(-1, 1, N), rng.uniform(-1, 1, N)
    body_to_ned = Rotation.from_euler("ZYX", np.c_[yaw, pitch, roll])
    if frame == "flu":
        ned_to_enu = Rotation.from_matrix([[0, 1, 0], [1, 0, 0], [0, 0, -1]])
        flu_to_frd = Rotation.from_matrix(np.diag([1.0, -1.0, -1.0]))
        logged = ned_to_enu * body_to_ned * flu_to_frd
    else:
        logged = body_to_ned
    x, y, z, w = logged.as_quat().T
    log = read_log(written(tmp_path, qw=w, qx=x, qy=y, qz=z), LogMap.model_validate({"frame": frame}))
    off = np.angle(np.exp(1j * (log.columns["psi"] - yaw)))
    assert (np.abs(off) <= log.error("psi")).all()
    # The turned quaternion is that of the contract's frames, up to its sign.
    turned = np.c_[[log.columns[q] for q in ("qx", "qy", "qz", "qw")]].T
    assert np.allclose(np.abs(np.sum(turned * body_to_ned.as_quat(), axis=1)), 1.0, atol=1e-12)
    assert any("psi follows from the attitude" in n for n in log.notes)


def test_attitudes_that_say_nothing_are_missing(tmp_path):
    q = np.tile([1.0, 0.0, 0.0, 0.0], (N, 1))
    q[:, 3] = 0.3 * np.sin(T)
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    q[5], q[6] = 0.0, [0.5, 0.5, 0.5, 3.0]
    q[7] = Rotation.from_euler("ZYX", [0.3, np.pi / 2, 0.0]).as_quat()[[3, 0, 1, 2]]
    log = read_log(written(tmp_path, **dict(zip(("qw", "qx", "qy", "qz"), q.T, strict=True))))
    np.testing.assert_array_equal(np.flatnonzero(np.isnan(log.columns["psi"])), [5, 6, 7])
    assert any("3 attitudes are not of norm 1" in n for n in log.notes)
    with pytest.raises(IvsidError, match="not qz; an attitude needs"):
        read_log(written(tmp_path, qw=q[:, 0], qx=q[:, 1], qy=q[:, 2]))


BOAT = 'name = "a"\n[hull]\nmass = 1\n[sensors.velocity]\naccuracy = 0.02\nscale_factor_error = 0.01\n'


def test_body_velocities_from_earth_velocities_hold_the_truth(tmp_path):
    rng = np.random.default_rng(4)
    psi, u, v = 0.4 * T, 1.0 + 0.2 * np.sin(T), 0.1 * np.cos(T)
    north, east = u * np.cos(psi) - v * np.sin(psi), u * np.sin(psi) + v * np.cos(psi)
    worst = rng.choice([-1.0, 1.0], (3, N))
    columns = {
        "velocity_north": north * 1.01 + 0.02 * worst[0],
        "velocity_east": east * 1.01 + 0.02 * worst[1],
        "psi": psi + 0.03 * worst[2],
    }
    columns["velocity_north"][4] = np.nan
    log = read_log(written(tmp_path, **columns))
    assert log.derived["u"] == ("velocity_north", "velocity_east", "psi")
    bounded = bound_log(log, parse_vehicle(BOAT + "[sensors.heading]\naccuracy = 0.03\n", "a.toml"))
    for name, truth in (("u", u), ("v", v)):
        x, there = bounded.channels[name], bounded.present[name]
        assert there.sum() == N - 1 and not there[4] and x.upper[4] == np.inf
        assert ((x.lower <= truth) & (truth <= x.upper))[there].all()
        assert (x.upper - x.lower)[there].max() < 0.2
    with pytest.raises(IvsidError, match=r"needs \[sensors.heading\] accuracy"):
        bound_log(log, parse_vehicle(BOAT, "a.toml"))


def test_earth_velocities_without_a_heading_are_refused(tmp_path):
    with pytest.raises(IvsidError, match="no psi"):
        read_log(written(tmp_path, velocity_north=T, velocity_east=np.sin(T)))


def test_pwm_with_its_neutral(tmp_path):
    pwm = 1500.0 + 20 * np.arange(N)
    vehicle = parse_vehicle(
        'name = "a"\n[hull]\nmass = 1\n[[thrusters]]\nname = "bow"\ngain = 0.05\nneutral = 1500\n', "a.toml"
    )
    log = read_log(written(tmp_path, RC1=pwm), LogMap.model_validate({"columns": {"demand_bow": "RC1"}}))
    np.testing.assert_allclose(ThrustCurve(vehicle.thrusters[0]).value(log.columns["demand_bow"]), 0.05 * (pwm - 1500))


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("[log.rates]\nu = -1\n", ["log.rates.u = -1", "greater than 0"]),
        ("[log]\nclock_error = -1\n", ["log.clock_error = -1"]),
        ("[log]\nbasis = 'u'\n", ["log.basis is unknown", "did you mean base?"]),
        ("[log.columns]\nu = { from = 'x', mising = 0 }\n", ["mising", "did you mean missing?"]),
        (
            "[log.columns]\nu = { from = 'x', time = { from = 's', unit = 'fortnight' } }\n",
            ["fortnight", "use one of s, ms"],
        ),
    ],
)
def test_wrong_keys_of_a_map(text, parts):
    with pytest.raises(IvsidError) as caught:
        parse_vehicle('name = "a"\n[hull]\nmass = 3\n' + text, "boat.toml")
    sentence = str(caught.value)
    assert "boat.toml" in sentence and "\n" not in sentence
    for part in parts:
        assert part in sentence


def test_the_angle_of_a_thruster_comes_with_its_demand(tmp_path):
    """Other columns of such a name are none of ours: they may hold words."""
    n = len(T)
    path = written(tmp_path, demand_bow=T, azimuth_bow=np.sin(T), rudder_mode=["auto"] * n, azimuth_stern=["ok"] * n)
    log = read_log(path)
    assert set(log.columns) == {"demand_bow", "azimuth_bow"} and set(log.ignored) == {"rudder_mode", "azimuth_stern"}
    mapped = read_log(path, LogMap.model_validate({"columns": {"rudder_bow": {"from": "azimuth_bow", "unit": "deg"}}}))
    np.testing.assert_allclose(mapped.columns["rudder_bow"], np.radians(np.sin(T)))


def test_a_fault_in_a_table_of_a_column_is_named_by_its_key():
    text = 'name = "a"\n[hull]\nmass = 1\n[log]\ncolumns = {{ u = {} }}\n'
    with pytest.raises(
        IvsidError, match=r"log\.columns\.u\.scale = nan is not usable: input should be a finite number"
    ):
        parse_vehicle(text.format('{ from = "u", scale = nan }'), "v.toml")
    with pytest.raises(IvsidError, match=r"log\.columns\.u = 3 is not usable"):
        parse_vehicle(text.format("3"), "v.toml")
    with pytest.raises(IvsidError, match="key log.columns.u.form is unknown; did you mean from"):
        parse_vehicle(text.format('{ from = "u", form = "u" }'), "v.toml")


def test_elements_of_an_array_are_columns_whose_number_is_no_unit(tmp_path):
    path = written(tmp_path, **{"xyz[2]": np.sin(T), "speed [kn]": 1 + T})
    log = read_log(path, LogMap(columns={"r": "xyz[2]", "u": "speed"}))
    np.testing.assert_array_equal(log.columns["r"], np.sin(T))
    np.testing.assert_allclose(log.columns["u"], (1 + T) * 1852 / 3600, rtol=1e-12)
