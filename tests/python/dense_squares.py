"""Least squares on the dense rows of a log: an oracle that knows of no cross-products."""

import numpy as np
from scipy.linalg import lstsq


def least_squares(g, at):
    """Fall of chi-squared by a further column beside a base, priors as rows; none by one with a negative number, if it has a sign."""
    base = g.columns(at).reshape(len(at), -1)
    soft = np.diag(np.sqrt(g.prior[list(at)]))
    right = np.r_[g.y.ravel(), -soft @ g.centre[list(at)]]

    def solved(more):
        A = np.vstack([np.vstack([base, *more]).T, np.hstack([soft, np.zeros((len(soft), len(more)))])])
        x = lstsq(A, right)[0]
        return float(np.sum((right - A @ x) ** 2)), x[-1]

    least = solved([])[0]

    def fall(column, signed):
        chi2, number = solved([column])
        return least - chi2 if signed or number > 0 else 0.0

    return fall
