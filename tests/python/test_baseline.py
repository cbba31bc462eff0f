"""Benchmarks beside a saved baseline: the table of `make bench-compare`."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="module")
def bench() -> ModuleType:
    """``benches/baseline.py``."""
    source = Path(__file__).parents[2] / "benches" / "baseline.py"
    spec = importlib.util.spec_from_file_location("baseline", source)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def measured(folder: Path, lower: float, estimate: float, upper: float) -> None:
    """A measurement as criterion writes it."""
    folder.mkdir(parents=True)
    median = {"point_estimate": estimate, "confidence_interval": {"lower_bound": lower, "upper_bound": upper}}
    (folder / "estimates.json").write_text(json.dumps({"mean": {"point_estimate": 0.0}, "median": median}))


def test_medians_are_paired_and_judged_by_their_intervals(
    bench: ModuleType, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, before, after in (
        ("sweep/n=3/1000", (99, 100, 101), (49, 50, 51)),
        ("hull/n=3", (99, 100, 101), (109, 110, 111)),
        ("exp/avx2", (90, 100, 110), (95, 105, 115)),
    ):
        measured(tmp_path / name / "before", *before)
        measured(tmp_path / name / "new", *after)
    measured(tmp_path / "gone" / "before", 1, 2, 3)
    measured(tmp_path / "other" / "new", 1, 2, 3)
    bench.main("before", tmp_path)
    rows = [
        (line.split()[0], float(line.split()[5]), line.split()[6:]) for line in capsys.readouterr().out.splitlines()
    ]
    assert rows == [("sweep/n=3/1000", 0.5, ["faster"]), ("hull/n=3", 1.1, ["slower"]), ("exp/avx2", 1.05, [])]


def test_a_baseline_that_is_missing_is_named(bench: ModuleType, tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match="has a baseline after"):
        bench.main("after", tmp_path)
