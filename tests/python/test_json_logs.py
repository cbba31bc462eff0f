"""Logs in JSON: records, a record a line, columns, messages of topics, packed by gzip."""

import gzip
import json

import numpy as np
import pytest

import program_logs as programs
from ivsid import IvsidError, read_log
from ivsid.files.log_map import LogMap
from ivsid.proposal import propose

MOTION = programs.Motion(20.0, 10.0)
COLUMNS = {n: getattr(MOTION, n).tolist() for n in ("t", "u", "v", "r")}
RECORDS = [dict(zip(COLUMNS, cells, strict=True)) for cells in zip(*COLUMNS.values(), strict=True)]
ROWS = [list(r.values()) for r in RECORDS]
BY_ROW = {n: {str(k): x for k, x in enumerate(c)} for n, c in COLUMNS.items()}


@pytest.mark.parametrize(
    "text",
    [
        json.dumps(RECORDS),
        json.dumps(RECORDS, indent=1),
        "\n".join(map(json.dumps, RECORDS)),
        json.dumps(COLUMNS),
        json.dumps(BY_ROW),
        json.dumps({"columns": list(COLUMNS), "index": list(range(len(ROWS))), "data": ROWS}),
        json.dumps({"vessel": {"name": "A"}, "samples": RECORDS}),
        json.dumps([list(COLUMNS), *ROWS]),
    ],
)
def test_samples_of_json_are_those_of_the_columns(tmp_path, text):
    path = tmp_path / "run.json"
    path.write_text(text)
    packed = tmp_path / "run.json.gz"
    packed.write_bytes(gzip.compress(text.encode()))
    for given in (path, packed):
        log = read_log(given)
        np.testing.assert_array_equal(log.t, MOTION.t)
        for name in ("u", "v", "r"):
            np.testing.assert_array_equal(log.columns[name], COLUMNS[name])


def test_an_epoch_keeps_its_digits_and_null_is_no_sample(tmp_path):
    path = tmp_path / "run.jsonl"
    path.write_text("".join(f'{{"t": 1700000000.{k}00000001, "u": {"null" if k == 3 else k}}}\n' for k in range(1, 9)))
    log = read_log(path)
    np.testing.assert_allclose(log.t, 0.1 * np.arange(8), rtol=0, atol=1e-15)
    assert np.isnan(log.columns["u"][2]) and np.isfinite(log.columns["u"][3])


def test_messages_of_topics_are_tables_of_their_own(tmp_path):
    m = MOTION
    named, bare = [], []
    for k in range(m.t.size):
        stamp = programs.EPOCH + float(m.t[k])
        twist = {"linear": {"x": m.u[k], "y": -m.v[k]}, "angular": {"z": -m.r[k]}}
        named.append({"topic": "/odom", "time": stamp, "msg": {"twist": {"twist": twist}}})
        bare.append({"time": stamp, "odom": {"twist": {"twist": twist}}})
        if k % 2:
            named.append({"topic": "/thrusters/port/command", "time": stamp, "msg": {"data": m.port[k]}})
            bare.append({"time": stamp, "thrusters": {"port": {"rpm": m.port[k]}}})
    path = tmp_path / "bag.jsonl"
    for lines in (named, bare):
        path.write_text("\n".join(map(json.dumps, lines)))
        found = propose([path])
        np.testing.assert_allclose(found.logs[0].columns["v"], m.v)
        np.testing.assert_allclose(found.logs[0].columns["r"], m.r)
        assert [d.name for d in found.demands] == ["port"] and found.columns.program.name == "ROS 2"


def test_messages_of_mavlink_are_known(tmp_path):
    path = tmp_path / "flight.json"
    lines = []
    for k in range(40):
        stamp = {"timestamp": programs.EPOCH + k / 10}
        yaw = {"mavpackettype": "ATTITUDE", "time_boot_ms": 100 * k, "yaw": 0.01 * k, "yawspeed": 0.1}
        place = {"mavpackettype": "LOCAL_POSITION_NED", "time_boot_ms": 100 * k, "vx": 1.0, "vy": 0.1 * k}
        lines += [json.dumps({"meta": stamp, "data": d}) for d in (yaw, place)]
    path.write_text("\n".join(lines))
    found = propose([path])
    assert found.columns.program.name == "MAVLink" and {"r", "psi", "velocity_north"} <= found.channels.keys()


def test_tables_of_one_file_have_lengths_of_their_own(tmp_path):
    path = tmp_path / "run.json"
    path.write_text(json.dumps({"nav": COLUMNS, "bus": {"t": [0.0, 10.0, 20.0], "voltage": [24, 23, 22]}}))
    log = read_log(path, LogMap.model_validate({"base": "nav"}))
    np.testing.assert_array_equal(log.columns["u"], COLUMNS["u"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"mass": 3, "name": "boat"}', "holds JSON without samples; give a list of records"),
        ("[]", "holds JSON without samples"),
        ("[[0, 1], [1, 2]]", "which are no names of columns"),
        ('[["t", "u"], [1, 2, 3]]', "row 1 has 3 cells where the first has 2 names"),
        ('{"t": [0, 1, 2], "u": [1, 2]}', r"unequal numbers of cells \(t 3, u 2\)"),
        ('[{"t": 0, "u": 1}, {"t": 1, ', "is no readable JSON .*; if it breaks off there"),
        ('{"t": 0, "u": 1}\n{"t": 1, "u', "line 2 is no readable JSON"),
        ('{"t": 0, "u": "fast"}\n{"t": 1, "u": 2}', "column u holds 'fast' in row 1"),
        ("[" * 5000 + "]" * 5000, "more than 100 deep"),
        ('{"a": ' * 300 + "1" + "}" * 300, "more than 100 deep"),
    ],
)
def test_what_is_no_log_gets_a_sentence(tmp_path, text, words):
    path = tmp_path / "run.json"
    path.write_text(text)
    with pytest.raises(IvsidError, match=words):
        read_log(path)
