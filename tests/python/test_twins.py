"""A small draw of the twins of ``make twins``: the truth is inside what is called guaranteed."""

import pytest

from twins import twin


@pytest.mark.parametrize("seed", range(12))
def test_the_truth_is_inside_under_noise_at_the_bounds(seed):
    found = twin(seed, "uniform")
    assert found["guaranteed"] and found["inside"], found
    assert found["ends"], "a result without a single end would hold any truth"


# Nightly: the second twin of each vehicle.
@pytest.mark.parametrize("seed", [0, 1, 2, *(pytest.param(k, marks=pytest.mark.nightly) for k in (3, 4, 5))])
def test_the_truth_is_inside_under_gaussian_noise_and_the_checker_agrees(seed):
    found = twin(seed, "gaussian", checked=True)
    assert found["guaranteed"] and found["inside"] and found["proved"], found


def test_three_sigma_is_not_called_guaranteed_and_here_is_why():
    """Of thousands of Gaussian samples some lie beyond three sigma: the set of the right model comes out empty."""
    found = twin(0, "gaussian", "sigmas = 3")
    assert found["vehicle"] == "SWAN" and found["rows"] == "pointwise"
    assert not found["guaranteed"] and not found["inside"] and found["status"] == "empty"
    assert twin(0, "gaussian")["inside"]
