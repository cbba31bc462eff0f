"""Files that the fuzzer of files found a fault with, and what their readers say now (``make fuzz-files``)."""

import json

import pytest

from conftest import embedded
from ivsid import IvsidError, identify, validate
from ivsid.identification.result import read_identification
from ivsid.programme.scenario import parse_scenario
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle


@pytest.mark.parametrize(
    ("old", "new"), [("period = 10.0", "period = 1e-320"), ("duration = 40.0", "duration = 1e308")]
)
def test_a_manoeuvre_of_any_length_is_driven(swan, old, new):
    """The number of turns of a period far below a sample, and of the samples of an endless segment, overflowed."""
    text = embedded("swan_train.toml").replace("duration = 300.0", "duration = 5.0", 1)
    assert old in text
    made = simulate(swan, parse_scenario(text.replace(old, new, 1), "plan.toml"), 1)
    assert made.t.size == 100


@pytest.mark.parametrize(
    ("thrusts", "last"),
    [
        ("[0.0, 1e308, -1e308]", "1e-4"),
        ("[0.0, 1e305, 2.0]", "1e-4"),
        ("[0.0, 1.0, 1e99]", "1e-4"),
        ("[0.0, 1.0, 2.0]", "1e308"),
    ],
)
def test_a_table_beyond_any_thruster_gets_a_sentence(thrusts, last):
    """The slopes of the interpolation overflowed."""
    text = (
        f"name = 'b'\n[hull]\nmass = 9\n[[thrusters]]\nname = 'p'\n[thrusters.table]\ndemand = [-1e-5, 0.0, {last}]\nthrust = "
        + thrusts
    )
    with pytest.raises(IvsidError, match=r"beyond 1e\+100; check its unit"):
        parse_vehicle(text, "b.toml")


@pytest.fixture(scope="module")
def stored(swan, programme, tmp_path_factory):
    """A result as its file, and the log that it was made of."""
    from conftest import as_log

    log = as_log(simulate(swan, programme.model_copy(update={"duration": 10.0}), 1))
    folder = tmp_path_factory.mktemp("stored")
    identify(swan, log, examine=False).save(folder)
    return folder / "result.json", log


EDITS = {
    "options": ({}, [], None, "x", 3),
    "options.window": (None, "1", [], -1.0, [0], {}, 1e400, True),
    "options.rows": (None, 3, [], "all", {"a": 1}),
    "options.form": (1, "both", None),
    "options.outliers": ("1", None, 0.5),
    "status": ("fine", None, 7),
    "method": (None, 7),
    "estimate": (None, [], {"mass.surge": "x"}, {"mass.surge": None}, {"mass.surge": True}, {"mass.surge": 10**400}),
    "parameters": (
        None,
        [],
        {"mass.surge": 3},
        {"mass.surge": {"lower": 1, "upper": "x", "unit": "kg", "symbol": "m"}},
    ),
    "notes": (None, "text", [1]),
    "inputs": ([], [{}], None, [{"name": "a", "sha256": "b"}]),
    "vehicle": (None, 3, ""),
    "setup": (None, [1], [{"id": 1}], [{"id": "a", "sentence": "b", "evidence": {}, "remedy": "c", "certain": "yes"}]),
    "certificates": (None, [1], {}),
    "physical": ([{}], [3], None),
    "directions": ([3], [{"a": "b"}], None),
    "rows": (None, {"surge": "x"}, [1]),
    "reason": (3, []),
    "inflation": ("x", []),
}


@pytest.mark.parametrize("part", EDITS)
def test_a_result_with_a_part_of_another_kind_gets_a_sentence(stored, part, tmp_path):
    file, log = stored
    for value in EDITS[part]:
        record = json.loads(file.read_text())
        holder, key = (record["options"], part.split(".")[1]) if "." in part else (record, part)
        for change in ("replace", "remove"):
            holder[key] = value
            if change == "remove":
                del holder[key]
            (tmp_path / "result.json").write_text(json.dumps(record))
            try:
                validate(read_identification(tmp_path), log)
            except IvsidError as refusal:
                assert "\n" not in str(refusal)
            else:
                # Results of older versions lack some parts.
                assert change == "remove" and part in ("setup", "physical"), (part, value)
