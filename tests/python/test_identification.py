"""From a log to parameter intervals."""

import json

import numpy as np
import pytest

from conftest import as_log
from ivsid import IvsidError, identify, verify
from ivsid.files.records import to_json
from ivsid.files.whole import write_whole
from ivsid.identification import METHODS, read_identification
from ivsid.log import Log
from ivsid.simulation import simulate
from ivsid.vehicle import parse_vehicle
from sampling import spaced


def drawn(programme, seed):
    """A scenario whose truth is drawn, too."""
    rng = np.random.default_rng(seed)
    truth = {
        "mass.surge": float(rng.uniform(55, 90)),
        "drag.surge.quadratic": float(rng.uniform(150, 400)),
        "inertia.yaw": float(rng.uniform(7, 20)),
    }
    return programme.model_copy(update={"truth": truth, "noise": "uniform", "duration": 60.0})


@pytest.mark.sampled
@pytest.mark.parametrize("part", range(4))
def test_the_feasible_interval_holds_the_truth_in_100_twins(swan, programme, part):
    for seed in spaced(range(25 * part, 25 * part + 25), 6):
        made = simulate(swan, drawn(programme, seed), seed)
        fit = identify(swan, as_log(made))
        assert fit.status in ("enclosed", "unbounded") and fit.guaranteed, seed
        for id_, value in made.truth["parameters"].items():
            p = fit.parameters[id_]
            assert p.lower <= value <= p.upper, (seed, id_)
        assert fit.inflation <= 1.0, seed


def test_guaranteed_methods_hold_the_truth_and_the_others_say_that_they_do_not_know(swan, twin):
    log = as_log(twin)
    fits = {m: identify(swan, log, m) for m in METHODS}
    for method, fit in fits.items():
        if fit.guaranteed:
            for id_, value in twin.truth["parameters"].items():
                assert fit.parameters[id_].lower <= value <= fit.parameters[id_].upper, (method, id_)
        if method.startswith("published"):
            assert not fit.guaranteed and fit.status in ("not_proved", "not_applicable")
    assert fits["feasible"].guaranteed
    for method in ("exact", "hansen-bliek-rohn", "krawczyk", "cramer"):
        for id_, p in fits[method].parameters.items():
            assert p.width > fits["feasible"].parameters[id_].width


def test_added_mass_form_is_the_total_form_shifted_or_wider(swan, twin):
    total = identify(swan, as_log(twin)).parameters["mass.surge"]
    added = identify(swan, as_log(twin), form="added").parameters["added_mass.surge"]
    truth = twin.truth["parameters"]["mass.surge"] - swan.hull.mass
    assert added.lower <= truth <= added.upper
    # The known mass stands on the other side of each row, so its acceleration's interval counts twice.
    assert added.lower <= total.lower - swan.hull.mass + 1e-9 and total.upper - swan.hull.mass - 1e-9 <= added.upper


def test_a_wrong_model_is_proved_wrong_with_its_rows(swan, programme):
    truth = {**programme.truth, "drag.surge.linear": 60.0}
    made = simulate(swan, programme.model_copy(update={"noise": "uniform", "truth": truth}), 4)
    fit = identify(swan, as_log(made))
    assert fit.status == "empty" and fit.guaranteed and not fit.parameters
    assert fit.inflation > 1
    record = json.loads(to_json(fit.record()))
    assert record["certificate"] and all(c["rows"] for c in record["certificate"])
    row = record["certificate"][0]["rows"][0]
    assert {"time", "channel", "lower", "upper", "right", "multiplier"} <= set(row)
    assert float.fromhex(row["lower"][0]) <= float.fromhex(row["upper"][0])
    assert set(fit.estimate) == {"mass.surge", "drag.surge.quadratic", "inertia.yaw"}


def test_three_sigma_results_are_not_called_guaranteed(swan, twin):
    vehicle = parse_vehicle(swan.text.replace("confidence = 0.999", "sigmas = 9"), "nine.toml")
    fit = identify(vehicle, as_log(twin))
    assert fit.status == "enclosed" and not fit.guaranteed
    assert any("not a bound for a log" in a for a in fit.assumes)


def test_a_vehicle_at_rest_leaves_its_parameters_open(swan, twin):
    from ivsid.log import Log

    rng = np.random.default_rng(0)
    still = {k: np.zeros(200) + (rng.standard_normal(200) * 1e-6) for k in ("u", "v", "r", "ax", "ay")}
    still |= {"demand_port": np.zeros(200), "demand_starboard": np.zeros(200)}
    fit = identify(swan, Log("still.csv", "", np.arange(200) * 0.05, still))
    assert fit.status == "unbounded"
    record = json.loads(to_json(fit.record()))
    assert record["parameters"]["mass.surge"]["upper"] is None
    assert fit.directions


def test_a_fit_survives_the_file(swan, twin, tmp_path):
    fit = identify(swan, as_log(twin))
    fit.save(tmp_path / "fit" / "result.json")
    again = read_identification(tmp_path / "fit")
    assert again.parameters == fit.parameters and again.estimate == fit.estimate
    assert again.vehicle == fit.vehicle and again.guaranteed


def test_files_that_are_no_fit_are_refused(tmp_path):
    for text, sentence in (
        ("{}", "not the result of ivsid identify"),
        ("[", "not JSON"),
        ('{"command": "identify"}', "damaged"),
    ):
        write_whole(tmp_path / "result.json", text)
        with pytest.raises(IvsidError, match=sentence):
            read_identification(tmp_path)
    with pytest.raises(IvsidError, match="cannot be read"):
        read_identification(tmp_path / "none")


def test_wrong_options_are_refused(swan, twin):
    log = as_log(twin)
    for options, sentence in (
        ({"method": "magic"}, "'magic' is not available; choose one of feasible"),
        ({"form": "half"}, "total or added"),
        ({"rows": "some"}, "pointwise"),
        ({"window": -1.0}, "positive length"),
        ({"partitions": -3, "method": "published"}, "at least 1"),
    ):
        with pytest.raises(IvsidError, match=sentence):
            identify(swan, log, **options)


def test_several_windows_are_an_intersection(swan, twin):
    """Each row holds by itself: no set of all rows is wider than that of one window."""
    fits = {str(w): identify(swan, as_log(twin), rows="integral", window=w) for w in (0.5, 2.0, [0.5, 2.0])}
    both = fits["[0.5, 2.0]"]
    assert both.options["window"] == [0.5, 2.0]
    assert both.rows["surge"] == sum(fits[w].rows["surge"] for w in ("0.5", "2.0"))
    for id_, p in both.parameters.items():
        for one in ("0.5", "2.0"):
            q = fits[one].parameters[id_]
            slack = 1e-9 * q.width
            assert q.lower - slack <= p.lower <= p.upper <= q.upper + slack
        assert p.lower <= twin.truth["parameters"][id_] <= p.upper
    assert both.parameters["drag.surge.quadratic"].width < 0.999 * min(
        fits[w].parameters["drag.surge.quadratic"].width for w in ("0.5", "2.0")
    )
    with pytest.raises(IvsidError, match="no window is given"):
        identify(swan, as_log(twin), rows="integral", window=[])
    with pytest.raises(IvsidError, match="longer than"):
        identify(swan, as_log(twin), rows="integral", window=[1.0, 1e4])


def test_what_is_determined_in_words():
    from ivsid.identification import in_words
    from ivsid.identification.combinations import determined

    (combination,) = determined(2, [np.array([0.3, -1.0])])
    assert combination == pytest.approx([1.0, 0.3])
    assert in_words({"mass.surge": 1.0, "drag.surge.quadratic": 0.3}) == "mass.surge + 0.3 drag.surge.quadratic"
    assert in_words({"a": -2.0, "b": -1.0}) == "-2 a - b"
    assert [list(c) for c in determined(3, [])] == [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    assert determined(2, [np.array([1.0, 0.0]), np.array([0.5, 1.0])]) == []
    rng = np.random.default_rng(1)
    for _ in range(200):
        n = int(rng.integers(2, 7))
        k = int(rng.integers(1, n))
        d = rng.normal(size=(k, n)) * 10.0 ** rng.integers(-3, 4, n)
        found = determined(n, list(d))
        assert len(found) == n - k
        for c in found:
            assert np.abs(d @ c).max() <= 1e-8 * (np.abs(d) @ np.abs(c)).max()


def test_a_log_at_constant_speed_determines_one_combination(swan):
    """Steady motion ties linear to quadratic drag: only their sum at that speed is known."""
    from ivsid.log import Log
    from ivsid.workflow.parameters import freedom_lines

    text = swan.text[: swan.text.index("[[thrusters]]")] + "[sensors" + swan.text.split("[sensors", 1)[1]
    text = (
        text.split("[model]")[0]
        + '[sensors.force]\naccuracy = 0.1\n[sensors.moment]\naccuracy = 0.1\n[model]\nterms = ["drag.surge.linear", "drag.surge.quadratic"]\n'
    )
    text = (
        text.replace("accuracy = 0.002", "accuracy = 0.0")
        .replace("scale_factor_error = 0.004", "")
        .replace("centre_of_gravity = [-0.00106, -0.00295]", "")
    )
    vehicle = parse_vehicle(text, "steady.toml")
    n = np.ones(200)
    zero = dict.fromkeys(("v", "r", "ax", "ay", "force_Y", "moment_N"), 0 * n)
    log = Log("steady.csv", "0" * 64, 0.05 * np.arange(200), {"u": 0.5 * n, "force_X": 3.0 * n, **zero})
    fit = identify(vehicle, log)
    assert fit.status == "unbounded"
    assert fit.determined == ({"drag.surge.linear": 1.0, "drag.surge.quadratic": pytest.approx(0.5, rel=1e-3)},)
    assert freedom_lines(fit) == [
        "of what is left open, only drag.surge.linear + 0.5 drag.surge.quadratic is determined"
    ]


def test_claims_are_checked_and_not_fitted(swan, twin):
    truth = twin.truth["parameters"]["mass.surge"]
    for value, wrong in ((truth, False), (truth + 40.0, True)):
        vehicle = parse_vehicle(swan.text + f'values = {{ "mass.surge" = {value!r} }}\n', "claim.toml")
        fit = identify(vehicle, as_log(twin))
        assert fit.claims == ({"parameter": "mass.surge", "value": value, "contradicted": wrong},)
        assert fit.parameters == identify(swan, as_log(twin)).parameters


def test_a_few_bad_samples_are_named_and_left_out(swan, programme, tmp_path):
    """Three spikes of the accelerometer contradict the truth; the intervals that allow them hold it again."""
    truth = {"mass.surge": 60.0, "inertia.yaw": 8.0, "drag.surge.quadratic": 250.0}
    made = simulate(swan, programme.model_copy(update={"noise": "uniform", "truth": truth, "duration": 60.0}), 3)
    columns = {k: v.copy() for k, v in made.columns.items()}
    columns["ax"][[200, 500, 800]] += 0.5
    log = Log("spikes.csv", "0" * 64, made.t, columns)
    assert identify(swan, log).status == "empty"
    fit = identify(swan, log, outliers=3)
    assert fit.status == "enclosed" and fit.guaranteed
    for id_, value in truth.items():
        assert fit.parameters[id_].lower <= value <= fit.parameters[id_].upper
    assert "all but 3 rows of each set of parameters that share rows hold" in fit.assumes
    block = next(b for b in fit.outliers if b["fewest"])
    assert block["fewest"] == 3
    times = [sorted(r["time"] for r in chosen) for chosen in block["sets"]]
    assert [made.t[k] for k in (200, 500, 800)] in times
    assert any("3 rows of" in n and "must be wrong" in n for n in fit.notes)
    clean = identify(swan, Log("clean.csv", "0" * 64, made.t, made.columns))
    wider = identify(swan, Log("clean.csv", "0" * 64, made.t, made.columns), outliers=1)
    for id_ in truth:
        assert wider.parameters[id_].lower <= clean.parameters[id_].lower
        assert clean.parameters[id_].upper <= wider.parameters[id_].upper
    assert all(b["fewest"] == 0 and not b["sets"] for b in wider.outliers)
    fit.save(tmp_path)
    assert read_identification(tmp_path).outliers == fit.outliers
    assert verify(tmp_path, log).proved
    with pytest.raises(IvsidError, match="outliers = 1 with method exact is not possible"):
        identify(swan, log, "exact", outliers=1)
