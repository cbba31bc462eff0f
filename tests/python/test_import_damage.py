"""Public sets that are damaged, incomplete, or in other folders than ours."""

import shutil

import numpy as np
import pytest

from ivsid import IvsidError
from ivsid.adapters import read_cse1, read_t200


def writable(real, folder):
    """A copy of the set that a test may damage."""
    shutil.copytree(real("cse1"), folder, copy_function=shutil.copyfile)
    for place in (folder, *folder.rglob("*")):
        place.chmod(0o755 if place.is_dir() else 0o644)
    return folder


def test_damaged_files_are_left_out_with_a_note(real, tmp_path):
    """A file that broke off, one of 30 bytes, a matrix of another shape, a recording without numbers; the rest is whole."""
    from scipy.io import savemat

    copy = writable(real, tmp_path / "cse1")
    free = copy / "freerun" / "CSE1_data_run1.mat"
    whole = free.read_bytes()
    for content in (whole[: len(whole) // 2], whole[:30], b""):
        free.write_bytes(content)
        made = read_cse1(copy)
        (note,) = [n for n in made.notes if n.startswith("left out")]
        assert "freerun/CSE1_data_run1.mat" in note and "\n" not in note
        assert set(made.logs) == {"random_run1", "random_run3"} and len(made.inputs) == 2 + 54 + 21 + 11 + 6
    savemat(free, {"cse1_data": np.zeros((4, 100))}, format="4")
    assert any("no matrix cse1_data of at least 14 rows" in n for n in read_cse1(copy).notes)
    savemat(free, {"other": np.zeros((4, 100))}, format="4")
    assert any(n.startswith("1 MATLAB files have no matrix cse1_data") for n in read_cse1(copy).notes)
    free.write_bytes(whole)
    asc = copy / "captive" / "VSPsway" / "vsp_sway_u2_10_pos.asc"
    for content, words in (("Time\tF8113\nnothing\n", "no Catman recording"), ("Time\tA\n0\t1\n1\t2\n", "it has A")):
        asc.write_text(content)
        made = read_cse1(copy)
        (note,) = [n for n in made.notes if n.startswith("left out")]
        assert "VSPsway/vsp_sway_u2_10_pos.asc" in note and words in note
        assert made.tables["vsp_sway"].demand.max() == 0.8 and len(made.logs) == 3


def test_a_set_of_damaged_files_alone_is_refused(tmp_path):
    (tmp_path / "run.mat").write_bytes(b"MATLAB 5.0 MAT-file, but short")
    with pytest.raises(IvsidError, match=r"holds no run of the set: run.mat .* which can be had from"):
        read_cse1(tmp_path)


def test_cse1_in_the_folders_of_its_publisher(real, tmp_path):
    """Folders with other names, at other depths, with copies of a recording and one name twice."""
    archive = tmp_path / "CS_EnterpriseI_archive" / "10 prev work"
    captive, free = archive / "2014 Tran" / "Matlab", archive / "2014 Tran" / "realWorldData"
    for folder, name in (
        ("SurgeDamping", "Damping"),
        ("VSPsurge", "surge"),
        ("VSPsway", "sway"),
        ("BowThruster", "bow"),
    ):
        shutil.copytree(real("cse1") / "captive" / folder, captive / name, copy_function=shutil.copyfile)
    (captive / "surge").chmod(0o755)
    free.mkdir()
    for k, run_ in enumerate(sorted((real("cse1") / "freerun").iterdir())):
        shutil.copyfile(run_, free / run_.name)
        (archive / f"copy {k}").mkdir()
    shutil.copyfile(free / "CSE1_data_run1.mat", archive / "copy 0" / "again.mat")
    shutil.copyfile(free / "CSE1_data_run1.mat", free / "CSE1_data_twice.mat")
    published, here = read_cse1(tmp_path / "CS_EnterpriseI_archive"), read_cse1(real("cse1"))
    assert len([n for n in published.notes if n.endswith("read once")]) == 2
    assert published.facts["towing"] == here.facts["towing"] and published.facts["slopes"] == here.facts["slopes"]
    assert sorted(len(p.t) for p in published.logs.values()) == sorted(len(p.t) for p in here.logs.values())
    shutil.rmtree(archive / "2014 Tran" / "realWorldData")
    shutil.rmtree(archive / "copy 0")
    assert not read_cse1(archive).logs and set(read_cse1(archive).tables) == set(here.tables)


def test_a_t200_table_without_its_columns(tmp_path):
    (tmp_path / "T200_16V.csv").write_text("a,b\n1,2\n2,3\n3,4\n")
    with pytest.raises(IvsidError, match="lacks a column PWM or Force"):
        read_t200(tmp_path)
    (tmp_path / "T200_16V.csv").write_text("PWM,Force\n1,2\n1,3\n3,4\n")
    with pytest.raises(IvsidError, match="do not increase"):
        read_t200(tmp_path)
    (tmp_path / "T200_xV.csv").write_text("PWM,Force\n1,2\n2,3\n3,4\n")
    with pytest.raises(IvsidError, match="tells no voltage"):
        read_t200(tmp_path)
