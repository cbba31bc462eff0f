"""The examiner's z: how far hidden effects stand out of a log, whatever is examined.

The case is simulated with its effects and read without noise. The plain model (masses, drags) predicts from each row's readings

    the acceleration there,                       d_a = (ax, ay) - prediction of (udot - v r, vdot + u r)
    the velocities one sample later,              d_1 = (reading - prediction) / h of u, v, r
    the heading and the place one sample later,   d_p = (reading - prediction) / h of psi, north, east

with the true thrust curves and the true ambient force, so that every d is 0 where nothing is hidden. Its spread in a log is that of
the sensors' stated noise and of the stated ambient force. At the frequency w, with S_x the spectrum of a sample of x and
D = (exp(i w h) - 1) / h, the errors of one channel are

    surge, sway:   d_1 = D n_v + f,   d_a = n_a + f          n_v, n_a: noise of velocity and acceleration, f: ambient force / mass
    yaw:           d_1 = D n_r + f,   d_p = D n_psi - n_r    and what n of other channels does to the predicted acceleration adds to f
    place:         d_p = D n_x - n_v - speed across * n_psi

Each frequency's rows are whitened by the Cholesky factor of that covariance (Whittle 1953). Then

    z^2 = min over theta of |W (d - J theta)|^2

over the masses and drags, which are free, the velocity's scale error inside its bound, slow errors of velocity, heading and place inside
their accuracy, piecewise linear between 7 times, and for each thruster an error inside its accuracy: a part that is piecewise linear over 33 demands, of demands that have risen and of those that have fallen apart, because the
errors of the examination jump and remember; and a part that is piecewise linear over 9 speeds of the water along the thruster. The
bound is split between the two in one of three ways, the same for all thrusters, and the smallest z counts. The error that a true
curve has already counts: what a curve may differ from it is what is left to the bound on either side. z is the least distance, in standard deviations, between the log with its effects and any log that
the vehicle file allows without them. Effects are never turned into columns: dead bands, delays, waves and sensors are treated alike,
by simulation. No code of the package is used.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import cholesky
from scipy.optimize import lsq_linear
from tests.exam.physics import Body, accelerations
from tests.exam.simulator import Motion, Vessel
from tests.exam.thrust_curves import Curve

# Demands at which the error of a thrust curve is free for either side, and Gauss-Newton steps of the model's numbers.
NODES = 33
# Speeds of the water along a thruster at which the other part of its error is free, and shares of the bound that the first part has.
SPEEDS = 9
SPLITS = (1.0, 0.5, 0.0)
# Times at which a slow error of a sensor is free.
TIMES = 7
# Least width of a box.
NARROW = 1e-9
ROUNDS = 4
# Steps of a least-squares problem inside a box: a strong effect drives hundreds of errors to their bounds.
STEPS = 5000
# Relative step of a difference.
SMALL = 1e-4
# Keeps the products of columns of unit length positive definite.
RIDGE = 1e-12
PARAMETERS = {
    "mass.surge": "m_u",
    "mass.sway": "m_v",
    "inertia.yaw": "i_r",
    "drag.surge.quadratic": "d_u",
    "drag.sway.quadratic": "d_v",
}
LINEAR = {"drag.yaw.linear": lambda r: r, "drag.yaw.quadratic": lambda r: r * abs(r)}


@dataclass
class Sailed:
    """A log of the examiner before its noise.

    Attributes:
        vessel: its numbers.
        motion: the true one.
        clean: readings without noise by column.
        curves: the thrust curves with their bounds.
    """

    vessel: Vessel
    motion: Motion
    clean: dict[str, np.ndarray]
    curves: tuple[Curve, ...]


def shown(logs: list[Sailed], claimed: tuple[str, ...] = ()) -> float:
    """z of everything that is hidden in the logs together.

    Args:
        logs: of one vehicle; the numbers of its model are the same in all.
        claimed: parameters of the model that the vehicle file states.
    """
    body = logs[0].vessel.body
    free = [i for i in (*PARAMETERS, *body.more) if i not in claimed]
    whiteners = [whitener(q) for q in logs]
    least = math.inf
    for _ in range(ROUNDS):
        base = [discrepancy(q, body) for q in logs]
        columns: list[np.ndarray] = []
        # No mass and no drag falls below a twentieth of its value in a step.
        box = [(-0.95, np.inf, 0.0, 0.0)] * len(free)
        for id_ in free:
            moved = _with(body, id_, _value(body, id_) * (1 + SMALL))
            rows = [w((discrepancy(q, moved) - d) / SMALL) for w, q, d in zip(whiteners, logs, base, strict=True)]
            columns.append(np.concatenate(rows))
        # Errors of thrust and of sensors belong to one log.
        for j, (w, q, d) in enumerate(zip(whiteners, logs, base, strict=True)):
            for column, *ends in _nuisance(q, body, d):
                rows = [np.zeros(_rows(p)) for p in logs]
                rows[j] = w(column)
                columns.append(np.concatenate(rows))
                box.append(ends)
        target = np.concatenate([w(d) for w, d in zip(whiteners, base, strict=True)])
        A = np.stack(columns, axis=1)
        ends = np.array(box)
        scale = np.linalg.norm(A, axis=0) + 1e-12
        # The triangular factor of the columns and the target, by way of their products: 40 columns of unit length.
        joined = np.column_stack([A / scale, target / (size := np.linalg.norm(target) + 1e-300)])
        R, q = cholesky(joined.T @ joined + RIDGE * np.eye(A.shape[1] + 1)), A.shape[1]
        R[:, q] *= size
        left, x = min(
            (_left(R[:q, :q], R[:, q], ends[:, :2] + (1 - split) * ends[:, 2:], scale) for split in SPLITS),
            key=lambda made: made[0],
        )
        if left > least * 0.999:
            break
        least = min(least, left)
        for id_, step in zip(free, x, strict=False):
            body = _with(body, id_, _value(body, id_) * (1 + step))
    return math.sqrt(least)


def _left(R: np.ndarray, target: np.ndarray, ends: np.ndarray, scale: np.ndarray) -> tuple[float, np.ndarray]:
    """What the columns inside a box leave of the target, and their amounts."""
    lower, upper = ends.T
    upper = np.maximum(upper, lower + NARROW)
    x = lsq_linear(R, -target[:-1], (lower * scale, upper * scale), max_iter=STEPS).x
    return float(np.linalg.norm(R @ x + target[:-1]) ** 2 + target[-1] ** 2), x / scale


def _value(body: Body, id_: str) -> float:
    return getattr(body, PARAMETERS[id_]) if id_ in PARAMETERS else body.more[id_]


def _with(body: Body, id_: str, value: float) -> Body:
    if id_ in PARAMETERS:
        return replace(body, **{PARAMETERS[id_]: value})
    return replace(body, more={**body.more, id_: value})


def _rows(q: Sailed) -> int:
    # Eight series, each of real and imaginary parts.
    return 16 * ((q.motion.t.size - 1) // 2 + 1)


def _rates(q: Sailed, body: Body, u, v, r, ambient, thrust):
    """udot, vdot, rdot of the plain model for arrays."""
    total = [ambient[:, j] for j in range(3)]
    for k in range(thrust.shape[1]):
        push = q.vessel.push(k, thrust[:, k], q.motion.angles[: len(u), k], u, v, r, m=np)
        total = [a + b for a, b in zip(total, push, strict=True)]
    for id_, value in body.more.items():
        total[2] = total[2] - value * LINEAR[id_](r)
    return accelerations(body, u, v, r, total)


def discrepancy(q: Sailed, body: Body) -> np.ndarray:
    """d_a of ax and ay, d_1 of u, v and r, d_p of heading, north and east, shape (8, n - 1)."""
    motion, c = q.motion, q.clean
    h, n = motion.t[1] - motion.t[0], motion.t.size - 1
    u, v, r, psi = (c[k][:n] for k in ("u", "v", "r", "psi"))
    near, far = motion.ambient[:n], motion.ambient[1:]
    thrust = motion.static[:n]

    def rates(s, share):
        a, b, w, heading = s
        udot, vdot, rdot = _rates(q, body, a, b, w, near + share * (far - near), thrust)
        co, si = np.cos(heading), np.sin(heading)
        return np.array([udot, vdot, rdot, w, co * a - si * b, si * a + co * b])

    s = np.array([u, v, r, psi])
    k1 = rates(s, 0.0)
    k2 = rates(s + 0.5 * h * k1[:4], 0.5)
    k3 = rates(s + 0.5 * h * k2[:4], 0.5)
    k4 = rates(s + h * k3[:4], 1.0)
    mean = (k1 + 2 * k2 + 2 * k3 + k4) / 6
    moved = np.stack([np.diff(c[k]) / h for k in ("u", "v", "r", "psi", "x", "y")]) - mean
    here = np.stack([c["ax"][:n] - (k1[0] - v * r), c["ay"][:n] - (k1[1] + u * r)])
    return np.concatenate([here, moved])


def _nuisance(q: Sailed, body: Body, base: np.ndarray):
    """What each declared error does to the discrepancies ``base`` of a log at its bound.

    With it stand the ends of what may be left of it where the errors of thrusts follow the demand alone, and how far the ends move where
    they follow the speed of the water alone.
    """
    sensors, n = q.vessel.table["sensors"], base.shape[1]
    if e := sensors["velocity"].get("scale_factor_error"):
        clean = q.clean | {k: q.clean[k] * (1 + SMALL * e) for k in ("u", "v")}
        yield (discrepancy(replace(q, clean=clean), body) - base) / SMALL, -1.0, 1.0, 0.0, 0.0
    t = q.motion.t
    knots = np.linspace(t[0], t[-1], TIMES)
    for sensor, channels in (("velocity", "u v"), ("heading", "psi"), ("position", "x y")):
        accuracy = sensors[sensor]["accuracy"]
        for channel in channels.split() if accuracy else []:
            for hat in np.eye(TIMES):
                clean = q.clean | {channel: q.clean[channel] + SMALL * accuracy * np.interp(t, knots, hat)}
                yield (discrepancy(replace(q, clean=clean), body) - base) / SMALL, -1.0, 1.0, 0.0, 0.0
    u, v, r = (q.clean[k] for k in ("u", "v", "r"))
    for k, curve in enumerate(q.curves):
        demand = q.motion.demands[:, k]
        bound = curve.bound(demand)
        static = q.motion.static.copy()
        static[:, k] += SMALL * bound
        whole = (discrepancy(replace(q, motion=replace(q.motion, static=static)), body) - base) / SMALL
        some = np.maximum(bound, 1e-12)
        held = (q.motion.static[:, k] - curve.nominal(demand)) / some
        c, s = q.vessel.direction(k, q.motion.angles[: u.size, k], np)
        px, py = q.vessel.thrusters[k]["position"]
        along = c * (u - py * r) + s * (v + px * r)
        drifts = q.vessel.drift[k](q.motion.static[:, k], along) / some if q.vessel.drift else np.zeros(bound.size)
        rising = sides(demand)
        # A demand holds for a sample, so that each sample answers to its own error alone.
        nodes, speeds = np.linspace(curve.low, curve.high, NODES), np.linspace(along.min(), along.max(), SPEEDS)
        shares = [
            (np.interp(demand, nodes, hat) * side, held, 1.0) for side in (rising, ~rising) for hat in np.eye(NODES)
        ]
        shares += [(np.interp(along, speeds, hat), drifts, -1.0) for hat in np.eye(SPEEDS)]
        for hats, has, follows in shares:
            share = (hats * (bound > 0))[:n]
            if share.any():
                own, room = float(share @ has[:n] / share.sum()), max(follows, 0.0)
                yield whole * share, -room - max(own, -1.0), room - min(own, 1.0), follows, -follows


def sides(demand: np.ndarray) -> np.ndarray:
    """Whether the last change of a demand, which begins at none, was a rise, shape (n,)."""
    change = np.diff(demand, prepend=0.0)
    last = np.maximum.accumulate(np.where(change != 0, np.arange(demand.size), -1))
    return (last < 0) | (change[np.maximum(last, 0)] > 0)


def whitener(q: Sailed):
    """A function from discrepancies, shape (8, n), to independent rows of unit variance, real."""
    motion, body, sensors = q.motion, q.vessel.body, q.vessel.table["sensors"]
    h, n = motion.t[1] - motion.t[0], motion.t.size - 1
    w = 2 * np.pi * np.fft.rfftfreq(n, h)
    D = (np.exp(1j * w * h) - 1) / h

    def wander(deviation: float, time: float) -> np.ndarray:
        memory = math.exp(-h / time)
        return deviation**2 * (1 - memory**2) / np.abs(1 - memory * np.exp(-1j * w * h)) ** 2

    def inertial(s) -> np.ndarray:
        return s["random_walk"] ** 2 / h + wander(s["bias_instability"], s.get("bias_time", 300.0))

    flat = np.ones_like(w)
    velocity = (sensors["velocity"]["accuracy"] / 3) ** 2 * flat
    heading = (sensors["heading"]["accuracy"] / 3) ** 2 * flat
    place = (sensors["position"]["accuracy"] / 3) ** 2 * flat
    gyro, accelerometer = inertial(sensors["yaw_rate"]), inertial(sensors["acceleration"])
    noise = (velocity, velocity, gyro)
    sea = q.vessel.table["ambient"]
    forces = [
        wander(sea[k], sea["time"]) / m**2
        for k, m in zip(("force", "force", "moment"), (body.m_u, body.m_v, body.i_r), strict=True)
    ]
    # Noise of a reading moves the predicted acceleration by its slope.
    u, v, r = motion.states[:n, 0], motion.states[:n, 1], motion.states[:n, 2]
    ambient, thrust = motion.ambient[:n], motion.static[:n]
    here = np.array(_rates(q, body, u, v, r, ambient, thrust))
    for j, step in enumerate(np.eye(3) * 1e-5):
        slope = (np.array(_rates(q, body, u + step[0], v + step[1], r + step[2], ambient, thrust)) - here) / 1e-5
        forces = [f + np.mean(s**2) * noise[j] for f, s in zip(forces, slope, strict=True)]
    across = [np.mean(r**2) * velocity + np.mean(q_**2) * gyro for q_ in (v, u)]
    # The first and the last reading stand in one difference each, and what they leave is in every frequency.
    size = np.abs(D) ** 2 + 2 / (h * h * n)
    pairs = [
        # Rows of ``discrepancy``, their variances, and the covariance of the first with the second.
        ((0, 2), accelerometer + across[0] + forces[0], size * velocity + forces[0], forces[0]),
        ((1, 3), accelerometer + across[1] + forces[1], size * velocity + forces[1], forces[1]),
        ((4, 5), size * gyro + forces[2], size * heading + gyro, -D * gyro),
    ]
    # An error of the heading turns the velocity that is summed to the place.
    alone = size * place + velocity + np.mean(u**2 + v**2) / 2 * heading

    def white(d: np.ndarray) -> np.ndarray:
        f = np.fft.rfft(d, axis=1, norm="ortho")
        # Every frequency but the first and, of an even length, the last stands for two.
        weight = np.full(w.size, math.sqrt(2.0))
        weight[0] = 1.0
        if n % 2 == 0:
            weight[-1] = 1.0
        out = []
        for (a, b), first, second, cross in pairs:
            # The Cholesky factor of [[first, cross], [conj(cross), second]], by hand.
            lower = np.conj(cross) / np.sqrt(first)
            rest = np.sqrt(np.maximum(second - np.abs(lower) ** 2, 1e-12 * second))
            one = f[a] / np.sqrt(first)
            out += [one, (f[b] - lower * one) / rest]
        out += [f[6] / np.sqrt(alone), f[7] / np.sqrt(alone)]
        rows = np.concatenate(out) * np.tile(weight, 8)
        return np.concatenate([rows.real, rows.imag])

    return white
