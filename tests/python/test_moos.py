"""Logs of MOOS-IvP: postings of variables, each with stamps of its own."""

import gzip

import numpy as np
import pytest

import program_logs as programs
from ivsid import IvsidError
from ivsid.proposal import propose

HEAD = "%% LOG FILE:       ./LOG_ALPHA.alog\n%% FILE OPENED ON  Fri May 31 12:00:00 2024\n%% LOGSTART           1717156800.5\n\n"


def alog(m):
    lines = []
    for k in range(m.t.size):
        t = m.t[k]
        for late, variable, value in (
            (0.001, "NAV_X", m.east[k]),
            (0.002, "NAV_Y", m.north[k]),
            (0.003, "NAV_HEADING", programs.compass(m.psi[k])),
            (0.004, "NAV_SPEED", m.u[k]),
            (0.005, "DESIRED_THRUST_L", m.port[k] - 1500),
            (0.005, "DESIRED_THRUST_R", m.starboard[k] - 1500),
            (0.006, "DESIRED_RUDDER", (m.starboard[k] - m.port[k]) / 8),
            (0.007, "NODE_REPORT_LOCAL", f"NAME=alpha,X={m.east[k]:.1f},MODE=ACTIVE NOW"),
        ):
            lines.append(f"{t + late:<15.5f} {variable:<22} pSource         {value}\n")
    return HEAD + "".join(lines)


def test_variables_are_channels_in_the_package_s_axes(tmp_path):
    m = programs.Motion(20.0, 5.0)
    text = alog(m)
    for name, content in (
        ("a.alog", text.encode()),
        ("b.log", text.encode()),
        ("c.alog.gz", gzip.compress(text.encode())),
    ):
        (tmp_path / name).write_bytes(content)
        found = propose([tmp_path / name])
        assert found.columns.program.name == "MOOS"
        np.testing.assert_allclose(found.channels["x"].values, m.north)
        np.testing.assert_allclose(found.channels["y"].values, m.east)
        np.testing.assert_allclose(found.channels["psi"].t - 0.003, m.t, atol=1e-9)
    assert [d.name for d in found.demands] == ["L", "R"]
    assert found.angles.keys() == {"rudder_L"}
    assert any("NAV_SPEED is taken for the speed along the hull" in q for q in found.questions)
    np.testing.assert_allclose(found.logs[0].columns["u"], m.u)


def test_a_log_without_numbers_gets_a_sentence(tmp_path):
    path = tmp_path / "run.alog"
    path.write_text(HEAD + "0.1 MODE pHelm ACTIVE\n0.2 MODE pHelm PARKED\n")
    with pytest.raises(IvsidError, match="no variable of MOOS with two numbers"):
        propose([path])


def test_a_synchronous_log_has_aligned_columns(tmp_path):
    m = programs.Motion(10.0, 5.0)
    path = tmp_path / "run.slog"
    rows = "".join(
        f"{t:10.3f} {x:12.5f} {y:12.5f} {u:9.5f}\n" for t, x, y, u in zip(m.t, m.east, m.north, m.u, strict=True)
    )
    path.write_text(HEAD + "%% TIME        NAV_X        NAV_Y    NAV_SPEED\n" + rows)
    found = propose([path])
    assert {"x", "y", "u"} <= found.channels.keys()
    np.testing.assert_allclose(found.logs[0].columns["x"], m.north, atol=1e-5)
