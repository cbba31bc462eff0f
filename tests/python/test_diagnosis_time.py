"""Time of a diagnosis with its figures and files, beside a fit by hand in the same run, so that a busy machine slows both."""

import importlib.util
from pathlib import Path

import pytest

# Fits by hand that a diagnosis may take as long as. At a load of 5 on two cores the ratios were 3.1, 6.3 and 10.6 (docs/diagnosis_measured.md); a third
# more is granted to other work. The aims of 2, 5 and 15 s on idle cores, where a fit takes about 1.2 s, are ratios of 1.7, 4.2 and 12.5.
MOST = {"nothing hidden": 4.2, "one effect": 8.4, "doubt": 12.5}


# Nightly: nine diagnoses of 600 s at 20 Hz.
@pytest.mark.nightly
@pytest.mark.figures
@pytest.mark.parametrize("name", MOST)
def test_a_diagnosis_takes_as_many_fits_by_hand_as_stated(name):
    source = Path(__file__).parents[2] / "benches" / "diagnosis.py"
    spec = importlib.util.spec_from_file_location("diagnosis_bench", source)
    bench = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bench)
    # Runs before and after each other: the least of three says what the program takes.
    _, ratio, said = bench.measured([name], 3)[name]
    assert ratio < MOST[name], said
    assert said.startswith("adequate" if name == "nothing hidden" else "wrong")
    assert ("null logs" in said) == (name == "doubt")
