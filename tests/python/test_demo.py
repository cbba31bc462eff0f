"""The demo: what its report must say."""

import json

import pytest

from ivsid import workflow
from ivsid.files.records import to_json
from ivsid.report import page
from pages import Page, faults


@pytest.fixture(scope="module")
def made():
    return workflow.demo()


def test_feasible_is_guaranteed_and_holds_the_truth(made):
    record = json.loads(to_json(made.record))
    fits = {f["method"]: f for f in record["identifications"]}
    assert set(fits) == {
        "feasible",
        "qr",
        "augmented",
        "exact",
        "hansen-bliek-rohn",
        "krawczyk",
        "cramer",
        "kuttler",
        "published",
        "published-hull",
        "partitioned",
        "neumaier",
    }
    assert fits["feasible"]["guaranteed"] and fits["feasible"]["status"] == "enclosed"
    for id_, value in record["truth"].items():
        p = fits["feasible"]["parameters"][id_]
        assert p["lower"] <= value <= p["upper"]
    for method in ("published", "published-hull"):
        assert not fits[method]["guaranteed"]


def test_what_the_published_inverse_is_worth(made):
    worth = made.record["published_inverse"]
    assert worth["published"]["improper"] > 0
    assert worth["published"]["enclosed_entries"] == worth["published-hull"]["enclosed_entries"] == 0
    widths = worth["width_over_feasible"]
    assert max(widths["published"].values()) > 10
    # Least-squares sets: the augmented system of a trial is too large, the other is never narrower than the feasible set.
    assert "augmented" not in widths and all(w >= 1 for w in widths.pop("qr", {}).values())
    # The surge block's A'A holds both signs off its diagonal: Kuttler's condition holds for the yaw block alone.
    assert set(widths.pop("kuttler")) == {"inertia.yaw"}
    assert all(max(w.values()) > 10 for w in widths.values())
    assert widths["exact"]["mass.surge"] <= widths["hansen-bliek-rohn"]["mass.surge"] < widths["krawczyk"]["mass.surge"]


def test_numbers_and_figures_of_the_paper_stand_in_the_report(made):
    written = page.html(made)
    assert faults(written) == [] and "On the second trial no rows contradict" in Page(written).text
    for words in (
        "Table V",
        "[-31.8686, 8.1316]",
        "[235.778, 275.778]",
        "Table IV",
        "28.8",
        "2.75",
        "not guaranteed",
        "improper",
        "+46.9 N at 85 %",
        "Fig. 1",
        "Fig. 2",
        "Fig. 3",
        "1.955",
    ):
        assert words in written, words
    names = {d.name for d in made.drawings}
    assert {
        "fig1_allan_acceleration",
        "fig2_allan_yaw_rate",
        "fig3_thrust",
        "fig4-7_surge_mid",
        "fig4-7_yaw_mid",
    } <= names
    assert {"fig4-7_surge_bounds", "fig4-7_yaw_bounds", "fig4-7_motion"} <= names


def test_the_trials_differ_and_respect_the_stated_limits(made):
    assert made.files["train.csv"] != made.files["test.csv"]
    assert made.record["inputs"][0]["sha256"] != made.record["inputs"][1]["sha256"]


def test_a_log_that_the_validation_has_not_seen_agrees(made):
    for force in made.record["validation"]["force"].values():
        assert force["falsified_samples"] == 0


def test_the_noise_of_table_ii_is_found_again(made):
    allan = made.record["allan"]
    assert allan["ax"]["random_walk"] == pytest.approx(0.0018, rel=0.03)
    assert allan["ay"]["random_walk"] == pytest.approx(0.002, rel=0.03)
    assert allan["r"]["random_walk"] == pytest.approx(1.745e-3, rel=0.03)
