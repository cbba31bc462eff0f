"""The declared scale of velocities: anywhere inside its bound it makes no finding, and its hint states the bound."""

import re
from dataclasses import replace

import pytest
from tests.exam.cases import setting

from ivsid import diagnose
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

VESSEL = {"ambient": 1.0, "duration": 300.0, "rate": 10.0, "share": 0.5}
NIGHT = [pytest.param(seed, side, marks=pytest.mark.nightly) for seed in range(92100, 92104) for side in (-1.0, 1.0)]


@pytest.mark.parametrize(("seed", "side"), [(40, 1.0), *NIGHT])
def test_velocities_at_the_bound_of_their_scale_make_no_finding(seed, side):
    here = setting(seed, **VESSEL)
    stated = float(re.search(r"scale_factor_error = (\S+)", here.text)[1])
    # The examiner draws no scale of its own.
    true = replace(here, text=here.text.replace(f"scale_factor_error = {stated}", "scale_factor_error = 0.0"))
    assert true.text != here.text
    logs = []
    for k, q in enumerate(true.logs({}), 1):
        moved = {name: x * (1 + side * stated) if name in "uv" else x for name, x in q.items() if name != "t"}
        logs.append(Log(f"{k}.csv", "0" * 64, q["t"], moved))
    result = diagnose(parse_vehicle(here.text, "vehicle.toml"), *logs)
    assert (result.verdict, result.findings) == ("adequate", ())
    said = [h for h in result.hints if h.startswith("velocities")]
    assert all(h.endswith(f"allows for {100 * stated:.3g} %") for h in said)
    # The position shows such a scale.
    assert said and re.search(r"([+-][\d.]+) %", said[0])[1].startswith("+" if side > 0 else "-")
