"""SWAN's equations of motion for the tests of tubes, written down apart from the product, with an integrator of others (SciPy's DOP853).

m (u' - v r) - m y_G r' - m x_G r^2 + d u|u| = X, m (v' + u r) + m x_G r' - m y_G r^2 + d v|v| = Y,
I r' + m x_G (v' + u r) - m y_G (u' - v r) = N; the couplings count with the dry mass, the rest with the paper's one mass and drag.
"""

import numpy as np
from scipy.integrate import solve_ivp

DRY, X_G, Y_G = 52.45, -0.00106, -0.00295
ARM = 0.30


def rates(state, m, d, inertia, force):
    """Rates of u, v, r, psi, x, y, each of shape (k,)."""
    u, v, r, psi, _, _ = state
    mx, my = DRY * X_G, DRY * Y_G
    right = np.stack(
        [
            force[0] + m * v * r + mx * r * r - d * u * np.abs(u),
            force[1] - m * u * r + my * r * r - d * v * np.abs(v),
            force[2] - mx * u * r - my * v * r,
        ],
        axis=-1,
    )
    matrix = np.zeros((m.size, 3, 3))
    matrix[:, 0, 0] = matrix[:, 1, 1] = m
    matrix[:, 2, 2] = inertia
    matrix[:, 0, 2] = matrix[:, 2, 0] = -my
    matrix[:, 1, 2] = matrix[:, 2, 1] = mx
    nu = np.linalg.solve(matrix, right[:, :, None])[:, :, 0].T
    c, s = np.cos(psi), np.sin(psi)
    return np.stack([*nu, r, u * c - v * s, u * s + v * c])


def thrust_force(port, starboard):
    """X, Y, N of both thrusters [N, N m]; port stands at y = -0.3 m."""
    return np.stack([port + starboard, 0 * port, ARM * (port - starboard)])


def integrate(start, m, d, inertia, t, thrust, error, straight=False):
    """Trajectories of k members, shape (n, 6, k).

    Args:
        start: shape (6, k).
        m, d, inertia: shape (k,).
        t: sample times, shape (n,).
        thrust: of both thrusters over each step, shape (n - 1, 2).
        error: from a step, a share of it in [0, 1] and the time to errors of both thrusters, shape (2, k); it may jump at the half of a step.
        straight: whether v and r are held at 0.
    """
    states = [start]
    for k in range(t.size - 1):
        middle = 0.5 * (t[k] + t[k + 1])
        for half, (a, b) in enumerate(((t[k], middle), (middle, t[k + 1]))):

            def rhs(time, flat, k=k, half=half):
                state = flat.reshape(6, -1)
                e = error(k, half, time)
                found = rates(state, m, d, inertia, thrust_force(thrust[k, 0] + e[0], thrust[k, 1] + e[1]))
                if straight:
                    # A rail takes all that would turn or move it sideways: with v = r = 0 the surge row stands alone.
                    found[:] = 0.0
                    found[0] = (2 * thrust[k].mean() + e[0] + e[1] - d * state[0] * np.abs(state[0])) / m
                return found.ravel()

            done = solve_ivp(rhs, (a, b), start.ravel(), method="DOP853", rtol=1e-11, atol=1e-13, first_step=b - a)
            assert done.success
            start = done.y[:, -1].reshape(6, -1)
        states.append(start)
    return np.stack(states)


def shapes(rng, k, t, reach, period):
    """Errors of both thrusters for k members, of all kinds: held, bang-bang, sawtooth, sine at a resonance, random, switched inside steps."""
    n = t.size
    kind = rng.integers(0, 6, (2, k))
    side = rng.choice([-1.0, 1.0], (2, k))
    switches = np.cumsum(rng.random((n, 2, k)) < 1 / 25, axis=0) % 2 * 2.0 - 1.0
    fast = rng.choice([-1.0, 1.0], (n, 2, 2, k))
    noise = rng.uniform(-1, 1, (n, 2, 2, k))
    length = rng.uniform(0.5, 2.0, (2, k)) * period
    phase = rng.uniform(0, 1, (2, k))

    def error(step, half, time):
        turns = time / length + phase
        made = [
            side,
            switches[step],
            # A sawtooth that stands still over half a step, so that no integration runs over its jumps.
            side * (2 * ((t[step] + 0.5 * half * (t[1] - t[0])) / length % 1.0) - 1),
            side * np.sin(2 * np.pi * turns),
            noise[step, half],
            fast[step, half],
        ]
        return reach * np.choose(kind, made)

    return error
