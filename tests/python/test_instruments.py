"""Text of instruments: Campbell's TOA5, LabVIEW's .lvm, and columns that blanks align."""

import gzip

import numpy as np
import pytest

import program_logs as programs
from ivsid import IvsidError, read_log
from ivsid.files.log_map import LogMap
from ivsid.proposal import propose

MOTION = programs.Motion(20.0, 10.0)
NAMES = ("u", "v", "r")
CELLS = np.column_stack([getattr(MOTION, n) for n in NAMES])


def rows(separator, first, form="{:.6f}"):
    return "".join(
        f(k) + separator + separator.join(form.format(x) for x in c) + "\n"
        for k, c in enumerate(CELLS)
        for f in (first,)
    )


def stamp(k):
    """As a Campbell logger writes it: without decimals on a whole second."""
    whole = f"2024-05-31 12:00:{k // 10:02d}"
    return whole if k % 10 == 0 else f"{whole}.{k % 10}"


def same(log, tolerance=1e-6):
    np.testing.assert_allclose(log.t - log.t[0], MOTION.t, atol=1e-9)
    for k, name in enumerate(NAMES):
        np.testing.assert_allclose(log.columns[name], CELLS[:, k], atol=tolerance)


TOA5 = (
    '"TOA5","boat","CR1000","12345","Std.32","CPU:boat.CR1","4321","Nav"\n"TIMESTAMP","RECORD","u","v","r"\n'
    '"TS","RN","m/s","m/s","deg/s"\n"","","Smp","Avg","Smp"\n'
)


def test_a_table_of_a_campbell_logger_has_four_rows_before_its_samples(tmp_path):
    text = TOA5 + rows(",", lambda k: f'"{stamp(k)}",{k}').replace("0.034710", '"NAN"')
    for name, content in (("cr.dat", text.encode()), ("cr.dat.gz", gzip.compress(text.encode()))):
        (tmp_path / name).write_bytes(content)
        found = propose([tmp_path / name])
        np.testing.assert_allclose(found.logs[0].columns["r"], np.radians(CELLS[:, 2]), atol=1e-6)
        np.testing.assert_allclose(found.logs[0].t, MOTION.t, atol=1e-9)


LABVIEW = (
    "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\nX_Columns\tKIND\nDate\t2024/05/31\nTime\t12:00:00,5\n"
    "***End_of_Header***\t\n\t\nChannels\t3\nSamples\t200\t200\t200\nY_Unit_Label\tm/s\tm/s\trad/s\nX_Dimension\tTime\tTime\tTime\n"
    "X0\t0,0\t0,0\t0,0\nDelta_X\t0.1\t0.1\t0.1\n***End_of_Header***\t\t\t\nX_Value\tu\tv\tr\tComment\n"
)


@pytest.mark.parametrize(("kind", "first"), [("One", lambda k: f"{k / 10:.6f}"), ("No", lambda _: "")])
def test_a_file_of_labview_has_two_headers_and_its_own_stamps(tmp_path, kind, first):
    path = tmp_path / "bench.lvm"
    path.write_text(LABVIEW.replace("KIND", kind) + rows("\t", first).replace(".", ","))
    same(read_log(path))


ALIGNED = {
    "words": "  t    u     v  r\n",
    "comment": "# made by hand\n#   t  u v   r\n",
    "units": "t [s]   u [m/s]  v (m/s)   r [rad/s]\n",
    "row": "   t      u      v      r\n   s    m/s    m/s  rad/s\n -----  ----   ----   ----\n",
    "rule": "   t      u      v      r\n-------------------------\n",
}


@pytest.mark.parametrize("header", ALIGNED.values(), ids=ALIGNED)
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_columns_may_be_aligned_by_blanks(tmp_path, header, end):
    path = tmp_path / "run.txt"
    header = header.replace(" -----  ----   ----   ----\n", "")
    path.write_bytes((header + rows("", lambda k: f"{k / 10:10.3f}", "{:14.6f}")).replace("\n", end).encode())
    same(read_log(path))


def test_names_of_several_words_and_dates_are_told_by_the_number_of_cells(tmp_path):
    path = tmp_path / "run.txt"
    path.write_text(
        "Time   Surge speed [m/s]   Sway speed [m/s]   Yaw rate [rad/s]\n"
        + rows("", lambda k: f"{stamp(k):<24}", "{:14.6f}")
    )
    found = propose([path])
    same(found.logs[0])
    assert found.channels["u"].match.column == "Surge speed [m/s]"
    # A faulty cell is named by its line in the file.
    path.write_text("  t     u\n  0.0   1.0\n  0.1   x\n")
    with pytest.raises(IvsidError, match="column u holds 'x' in row 3"):
        read_log(path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('"TOB1","boat","CR1000"\n', "in the form TOB1; convert it to TOA5"),
        ('"TOA5","boat"\n"TIMESTAMP","u"\n"TS","m/s"\n', "rows 2 to 4 hold names, units and processing"),
        (LABVIEW.replace("KIND", "Multi"), "a column of stamps for each channel"),
        (LABVIEW.replace("KIND", "No").replace("0.1\t0.1\n", "0.2\t0.1\n"), "its Delta_X states no common step"),
        (LABVIEW.partition("Channels")[0], "lacks .* or the row X_Value below it"),
        (
            LABVIEW.replace("KIND", "One") + "0\t1\t1\t1\n0.1\t1\t1\t1\n" + LABVIEW.partition("\t\nChan")[2],
            "has several headers",
        ),
        (
            "  surge speed  sway speed\n  0.0   1.0   2.0\n  0.1  1.0  2.0\n",
            "does not tell the names of its 3 cells a row",
        ),
    ],
)
def test_headers_that_are_not_understood_get_a_sentence(tmp_path, text, words):
    path = tmp_path / "run.txt"
    path.write_text(text)
    with pytest.raises(IvsidError, match=words):
        read_log(path, LogMap())
