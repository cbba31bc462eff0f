"""Free runs of two basins, in files of their publishers' layout that the tests write: units, signs, which rate is which, damaged files."""

import numpy as np
import pytest

from ivsid import IvsidError, identify, read_log, workflow
from ivsid.adapters import read_hsva, read_marin
from ivsid.report import page
from ivsid.vehicle import read_vehicle

HSVA = " HSVA, experimental data CPMC\n KVLCC2\n Z20\xb0/10\xb0 starting to port\n Time series of motions\n"
MARIN = "MARIN(Maritime Research Institute Netherlands)\nZig-zag manoeuvring for KVLCC2 : 20 / -20\n\n"


def motion(n=400, h=0.05):
    """A turn to port under a rudder that both basins call positive: heading and yaw rate [deg, deg/s] fall."""
    t = h * np.arange(n)
    rate = -1.2 * (1 - np.exp(-t / 6.0))
    return t, 1.17 - 0.004 * t, 0.03 * (1 - np.exp(-t / 5.0)), np.cumsum(rate) * h, rate


def hsva(path, other=7, **changed):
    """A run of HSVA; the yaw rate stands in column 7 or 8, a rate about another axis in the other."""
    t, u, v, psi, rate = motion()
    roll = 0.1 * np.sin(3 * t)
    rates = (rate, roll) if other == 7 else (roll, rate)
    columns = [t, u * t, 0 * t, psi, u, v, *rates, 20 + 0 * t, 10.23 + 0 * t, 42 + 0.1 * t, 1.02 + 0 * t]
    rows = [" ".join(f"{x:.9f}" for x in row) for row in np.c_[tuple(columns)]]
    path.write_bytes((changed.get("head", HSVA) + "\n".join(rows) + changed.get("tail", "\n")).encode("latin-1"))


def marin(path):
    t, u, v, psi, rate = motion(h=0.135)
    columns = [t, u * t, 0 * t, 0.1 * np.cos(t), psi, 6.9 * u, v, 0.05 * np.sin(2 * t), rate, 20 + 0 * t, 91.7 + 0 * t]
    rows = ["\t".join(f"{x:.6E}" for x in row) for row in np.c_[tuple(columns)]]
    path.write_text(MARIN + "\n".join(rows) + "\n", encoding="latin-1")


@pytest.mark.parametrize("other", [7, 8])
def test_units_signs_and_the_rate_that_the_heading_follows(tmp_path, other):
    (tmp_path / "runs").mkdir()
    hsva(tmp_path / "runs" / "HSVA_CPMC_KVLCC2_Z_20_10_P.dat", other)
    made = read_hsva(tmp_path)
    part = made.logs["HSVA_CPMC_KVLCC2_Z_20_10_P"]
    t, u, _, psi, rate = motion()
    assert part.t == pytest.approx(t) and part.columns["u"] == pytest.approx(u)
    assert part.columns["r"] == pytest.approx(np.radians(rate), abs=1e-9)
    assert part.columns["psi"] == pytest.approx(np.radians(psi), abs=1e-9)
    # The vessel turns to port, which is a rudder to port: negative here.
    assert (part.columns["rudder_propeller"] < 0).all() and part.columns["r"][-1] < 0
    assert part.columns["demand_propeller"][0] == pytest.approx(42.0)
    assert made.inputs[0][0] == "runs/HSVA_CPMC_KVLCC2_Z_20_10_P.dat"


def test_runs_at_full_scale_have_no_thrust_and_say_so(tmp_path):
    marin(tmp_path / "MARIN_FREE_KVLCC2_zz_20_m.dat")
    hsva(tmp_path / "HSVA_CPMC_KVLCC2_Z_20_10_P.dat")
    made = read_marin(tmp_path)
    (part,) = made.logs.values()
    assert part.columns["revolutions"] == pytest.approx(91.7 / 60)
    assert "demand_propeller" not in part.columns and made.vehicle is None
    assert any("no thrust was measured" in n for n in made.notes)
    assert not any("left out" in n for n in made.notes)
    assert list(read_hsva(tmp_path).logs) == ["HSVA_CPMC_KVLCC2_Z_20_10_P"]


@pytest.mark.parametrize(
    ("tail", "said"),
    [
        ("\n1.0 2.0\n", "has 2 of 12 numbers"),
        ("\nend of run\n", "holds no numbers"),
        ("\n" + "0 " * 12, "do not increase"),
    ],
)
def test_a_damaged_run_is_left_out_with_a_note(tmp_path, tail, said):
    hsva(tmp_path / "good.dat")
    hsva(tmp_path / "bad.dat", tail=tail)
    made = read_hsva(tmp_path)
    assert list(made.logs) == ["good"]
    assert [said in n for n in made.notes if n.startswith("left out: bad.dat")] == [True]
    (tmp_path / "good.dat").unlink()
    with pytest.raises(IvsidError, match="has no run of the set.*can be had from"):
        read_hsva(tmp_path)


def test_a_heading_that_no_rate_follows_is_refused(tmp_path):
    t, u, v, psi, _ = motion()
    columns = [t, u, v, psi, u, v, np.sin(5 * t), np.cos(7 * t), 0 * t, 0 * t, 0 * t, 0 * t]
    rows = [" ".join(f"{x:.9f}" for x in row) for row in np.c_[tuple(columns)]]
    (tmp_path / "a.dat").write_bytes((HSVA + "\n".join(rows)).encode("latin-1"))
    with pytest.raises(IvsidError, match="no column of the file is the slope of its heading"):
        read_hsva(tmp_path)


# Nightly: the gate identifies what is imported from CyberShip.
@pytest.mark.nightly
def test_what_is_imported_can_be_identified(tmp_path):
    hsva(tmp_path / "HSVA_CPMC_KVLCC2_Z_20_10_P.dat")
    page.write(workflow.import_set("hsva", tmp_path), tmp_path / "out")
    vehicle = read_vehicle(tmp_path / "out" / "kvlcc2.toml")
    log = read_log(tmp_path / "out" / "HSVA_CPMC_KVLCC2_Z_20_10_P.csv", vehicle.log)
    fit = identify(vehicle, log, examine=False)
    # The guesses of the file prove nothing, and it says so.
    assert not fit.guaranteed and set(fit.parameters) <= set(vehicle.model.terms)
