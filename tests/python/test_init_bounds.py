"""Bounds that no log shows: ``ivsid init`` says what it assumed, and how to state the sensor's own."""

import numpy as np
import polars as pl

import program_logs as programs
from ivsid.proposal import propose
from ivsid.workflow import init

M = programs.Motion(20.0, 10.0)


def written(path, **columns):
    pl.DataFrame({"t": M.t, "u": M.u, "v": M.v, "r": M.r, "rpm_port": M.port - 1600, **columns}).write_csv(path)
    return path


def test_guessed_bounds_are_said_on_the_terminal_and_in_the_file(tmp_path):
    made = init([written(tmp_path / "run.csv")], tmp_path / "boat.toml")
    text = (tmp_path / "boat.toml").read_text()
    for words in (
        "no log rests for 30 s, so the noise of yaw_rate is a guess from its scatter",
        "the bounds of velocity come from the scatter, and assume no constant error: add the sensor's own under [sensors.velocity]",
    ):
        assert f"#  - {words}" in text and any(words in line for line in made.lines)
    assert len(made.record["assumed"]) == 2


def test_a_channel_without_scatter_gets_a_share_of_its_range_and_one_that_stands_still_none(tmp_path):
    ramp = M.t / 10
    found = propose(
        [
            written(
                tmp_path / "run.csv",
                psi=0 * M.t,
                u=np.floor(ramp / 0.7),
                v=np.floor(ramp / 0.7),
                r=np.floor(ramp / 0.7),
            )
        ]
    )
    assert (
        found.sensors["velocity"][0].value == 0.02 and "hundredth of the range" in found.sensors["velocity"][0].reason
    )
    assert {n.key for n in found.sensors["yaw_rate"]} == {"random_walk", "bias_instability"}
    assert "heading" not in found.sensors
    assert any(a.startswith("u, v shows no scatter, so a hundredth of its range is assumed") for a in found.assumed)
    assert any("psi never changes" in a and "accuracy under [sensors.heading]" in a for a in found.assumed)


def test_a_log_at_rest_leaves_no_guess_of_the_noise(tmp_path):
    rng = np.random.default_rng(4)
    t = np.arange(3000) / 20
    still = {"t": t, "u": 0 * t, "v": 0 * t, "r": 1e-3 * rng.standard_normal(t.size), "rpm_port": 0 * t}
    pl.DataFrame(still).write_csv(tmp_path / "deck.csv")
    found = propose([written(tmp_path / "run.csv"), tmp_path / "deck.csv"])
    assert found.still is not None and not any("no log rests" in a for a in found.assumed)
