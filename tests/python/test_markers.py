"""Cells that stand for a missing sample: words of spreadsheets and loggers, and known numbers far outside of all others."""

import numpy as np
import pytest

from ivsid import read_log
from ivsid.files.log_map import LogMap
from ivsid.proposal import propose

T = np.arange(200) / 10
U = 1.2 + 0.3 * np.sin(T)
R = 0.2 * np.sin(0.7 * T)


def written(path, mark, every=17, header="t,u,r"):
    cells = [mark if k % every == 3 else f"{u:.6f}" for k, u in enumerate(U)]
    path.write_text(header + "\n" + "".join(f"{t},{c},{r:.6f}\n" for t, c, r in zip(T, cells, R, strict=True)))
    return path


@pytest.mark.parametrize(
    "mark", ["", "NaN", "NA", "N/A", "#N/A", "null", "NULL", "None", "-", "---", "*", "?", " NA ", "#NV", r"\N"]
)
def test_words_for_no_sample_are_none(tmp_path, mark):
    log = read_log(written(tmp_path / "log.csv", mark))
    gone = np.isnan(log.columns["u"])
    assert (np.flatnonzero(gone) % 17 == 3).all() and gone.sum() == 12
    assert any("u misses 12 of 200 samples" in n for n in log.notes)


@pytest.mark.parametrize(
    "mark", ["-9999", "9999", "999.25", "-999", "1e20", "-32768", "9.96921e36", "2147483647", "-9999.0"]
)
def test_known_numbers_far_outside_are_no_samples_and_are_noted(tmp_path, mark):
    log = read_log(written(tmp_path / "log.csv", mark))
    assert np.isnan(log.columns["u"]).sum() == 12 and np.nanmax(np.abs(log.columns["u"])) < 2
    assert any(f"u holds {float(mark):.10g} in 12 cells" in n for n in log.notes)
    assert any("that hold" in a and "are missing samples" in a for a in log.assumes)


def test_two_markers_of_a_column_are_both_found_and_shape_no_proposal(tmp_path):
    path = written(tmp_path / "log.csv", "-9999")
    text = path.read_text().splitlines()
    text[100] = "9.9,1e20,0.1"
    path.write_text("\n".join(text) + "\n")
    found = propose([path])
    assert np.isnan(found.logs[0].columns["u"]).sum() == 13
    assert {n.key: n.value for n in found.sensors["limits"]}["acceleration"] < 1
    assert found.sensors["velocity"][0].value < 0.1


def test_a_number_that_a_sensor_can_read_is_a_sample(tmp_path):
    # As large as a marker, and others near it.
    path = tmp_path / "log.csv"
    path.write_text("t,u,demand_a\n" + "".join(f"{k},{k},{[0, 1200, 9999, 999][k % 4]}\n" for k in range(20)))
    log = read_log(path)
    assert (
        not log.assumes and np.nanmax(log.columns["demand_a"]) == 9999 and not np.isnan(log.columns["demand_a"]).any()
    )
    # The vehicle file names another marker: the rule rests.
    mapping = LogMap.model_validate({"columns": {"u": {"from": "u", "missing": -1.0}}})
    log = read_log(written(tmp_path / "b.csv", "-9999"), mapping)
    assert np.nanmin(log.columns["u"]) == -9999
