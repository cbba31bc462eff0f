"""A generic dictionary of regressors: powers and products of velocities, thrusts, heading, place and time in every channel, and memories of the motion and of the path.

Source: docs/theory.md, "Diagnosis"; Abkowitz, *Lectures on Ship Hydrodynamics*, 1964 (products of the third order); Fedyaevsky and Sobolev 1963 and
Norrbin 1970 (moduli); Cummins, "The impulse response function and ship motions", Schiffstechnik 9, 1962 (memory of the water).
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.modulated import modulated, of_unit_size
from ivsid.diagnosis.plant.usual_hull import hull_length
from ivsid.effects import CHANNELS
from ivsid.linear.filters import decaying, respond
from ivsid.vehicle import KnownForce

Array = NDArray[np.float64]
SYMBOLS: Final = re.compile(r"[a-z]+")
# Last word of the regressors that remember the motion.
MEMORY: Final = "memory"
# What forces that the log holds are called, in the place of thrusts.
KNOWN: Final = "known force"
# Thrusters that have regressors of their own.
# Source: resource: each adds three columns
THRUSTERS: Final = 4
# Harmonics of the heading: loads of wind and waves on a hull have a series of them.
# Source: physics: coefficients of wind loads bend as a third and a fourth harmonic do (Blendermann, *J. Wind Eng. Ind. Aerodyn.* 51, 1994)
HARMONICS: Final = 4
# Times over which the water remembers the motion, in those of a wave of the hull's length, sqrt(L / g).
# Source: physics: radiated waves are about gone after one to a few of these times (Cummins 1962), and a free surface in a tank swings as long
MEMORIES: Final = (1.0, 4.0)
# Periods of liquids that swing in tanks, in times of a wave of the hull's length.
# Source: physics: a free surface of width b and depth d swings in sqrt(4 pi b / (g tanh(pi d / b))), and tanks are a tenth to a whole beam wide
SWINGS: Final = tuple(2.0 * 1.35**k for k in range(7))
# Their damping, as a share of the critical one.
# Source: geometry: a resonance of that width sees what swings a sixth of a period beside its own
SWINGING: Final = 0.15
# Least period of such a liquid, in steps of the clock.
# Source: geometry: eight samples a period show its shape
LEAST_PERIOD: Final = 8.0
# Lengths of the way over which a body in tow forgets a turn, in those of the hull.
# Source: physics: a body that is towed by its front follows a tractrix of the cable's length, and cables are two to some hulls long
TRAILS: Final = (2.0, 6.0)
# Acceleration of gravity [m/s^2].
# Source: physics: standard gravity, ISO 80000-3
GRAVITY: Final = 9.80665
# First words of the errors of a gyro, and of an accelerometer.
WRONG: Final = "yaw rate read wrong with"
FELT: Final = "acceleration read wrong with"
# How much of each is added, as a share of a reading [1, or rad/s a m/s^2]: the answer to a small one is linear in it.
# Source: geometry: a hundredth, as of the scale of a gyro
SHARE: Final = 0.01
# Parts of the largest demand at which an accelerometer may be shaken.
# Source: geometry: a resonance of a twelfth of the range lies in one of them, or in two
SHAKEN: Final = 6
# Least time of a memory, in steps of the clock.
# Source: geometry: a shorter one is the acceleration itself, which the model's own columns hold
LEAST_MEMORY: Final = 2.0
# Least ambient acceleration by which regressors are scaled [m/s^2, rad/s^2].
# Source: definition: keeps the columns from zero where the ambient force is zero
LEAST_AMBIENT: Final = 1e-6


# Names ``channel|function``, columns and lengths of the dictionary's regressors.
Regressors: TypeAlias = "tuple[list[str], Array, Array]"


def regressors(fit: Fit, *, turning: bool = False) -> Regressors:
    """The dictionary's regressors: names ``channel|function``, whitened columns in unit length, (regressors, blocks, numbers), and their lengths.

    Args:
        fit: of the model.
        turning: whether functions of the yaw rate count where yaw is left out.
    """
    names, arrays = _dictionary(fit, turning=turning)
    g, predictor = fit.gram, fit.noise.predictor
    read = [*_gyro(fit), *_accelerometer(fit)]
    columns = [predictor.answer(a) for a in arrays]
    columns += [predictor.misread(fit.states, wrong, mass=fit.signatures.mass) for _, wrong in read]
    x, unit = g.white.blocks(columns, g.good, g.length)
    return [*names, *(name for name, _ in read)], x.reshape(-1, *g.y.shape), unit


def in_words(name: str) -> str:
    """``function in channel`` of a regressor ``channel|function``."""
    channel, function = name.split("|", 1)
    return f"{function} in {channel}"


def _dictionary(fit: Fit, *, turning: bool) -> tuple[list[str], list[Array]]:
    """Names ``channel|function`` of the regressors and their accelerations, each of shape (3, 2 n)."""
    p = fit.states.points
    u, v, r = p.nu
    predictor = fit.noise.predictor
    n = predictor.log.n
    scale = [max(float(np.sqrt(np.mean(x**2))), 1e-9) for x in (u, v, r)]
    a, b, c = u / scale[0], v / scale[1], r / scale[2]
    t = (p.t - p.t[0]) / (p.t.max() - p.t[0])
    functions: dict[str, Array] = {
        "1": np.ones(2 * n),
        "u": a,
        "v": b,
        "r": c,
        "u^2": a * a,
        "v^2": b * b,
        "r^2": c * c,
        "u|u|": a * np.abs(a),
        "v|v|": b * np.abs(b),
        "r|r|": c * np.abs(c),
        "u v": a * b,
        "u r": a * c,
        "v r": b * c,
        "u^3": a**3,
        "v^3": b**3,
        "r^3": c**3,
        "u^2 r": a * a * c,
        "u^2 v": a * a * b,
        # Of the third order in surge, and the moduli in sway and yaw, of manoeuvring models.
        "u v^2": a * b * b,
        "u r^2": a * c * c,
        "v|r|": b * np.abs(c),
        "r|v|": c * np.abs(b),
        "t": t,
        "t^2": t * t,
        "t u|u|": t * a * np.abs(a),
    }
    if len(p.thrusts):
        total = p.thrusts.sum(axis=0)
        size = max(float(np.sqrt(np.mean(total**2))), 1e-9)
        force = total / size
        before = np.concatenate([np.r_[force[0], force[: n - 1]], np.r_[force[n], force[n:-1]]])
        own = [(k, t) for k, t in enumerate(predictor.vehicle.thrusters) if t.own]
        name = KNOWN if any(isinstance(t, KnownForce) for _, t in own) else "thrust"
        functions |= {
            name: force,
            f"{name}^2": force * np.abs(force),
            f"{name} u": force * a,
            f"change of {name}": force - before,
            f"t {name}": t * force,
        }
        for k, thruster in own[:THRUSTERS]:
            functions[thruster.words.removeprefix("the ")] = p.thrusts[k] / size
    if predictor.log.psi is not None:
        cosine, sine = np.cos(p.psi), np.sin(p.psi)
        functions |= {"cos psi": cosine, "sin psi": sine, "u cos psi": a * cosine, "u sin psi": a * sine}
        for k in range(2, HARMONICS + 1):
            functions |= {f"cos {k} psi": np.cos(k * p.psi), f"sin {k} psi": np.sin(k * p.psi)}
    if predictor.log.place is not None:
        x, y = (q - q.mean() for q in p.place)
        reach = max(float(np.abs(x).max()), float(np.abs(y).max()), 1e-9)
        functions |= {"x": x / reach, "y": y / reach, "x u": x / reach * a, "y u": y / reach * a}
    if fit.noise.left_out and not turning:
        # Axes that are left out have no fitted model, so functions of their velocities show no cause.
        functions = {k: f for k, f in functions.items() if "r" not in set(SYMBOLS.findall(k))}
    names, arrays, trails = [], [], list(_trails(fit))
    sizes = [max(d, LEAST_AMBIENT) for d in predictor.ambient.deviation]
    for k, axis in enumerate(CHANNELS):
        for name, f in functions.items():
            process = np.zeros((3, 2 * n))
            process[k] = sizes[k] * f
            names.append(f"{axis}|{name}")
            arrays.append(process)
        for name, f in (*_memories(fit, k), *_swings(fit, k), *((name, pulls[min(k, 1)]) for name, pulls in trails)):
            process = np.zeros((3, 2 * n))
            process[k] = sizes[k] * f
            names.append(f"{axis}|{name}")
            arrays.append(process)
    for name, force in zip(*modulated(fit)[:2], strict=True):
        # A thrust acts along its axis: the channel is the one in which most of it is.
        most = np.argmax([float(np.mean(x**2)) / size**2 for x, size in zip(force, sizes, strict=True)])
        names.append(f"{CHANNELS[most]}|{name}")
        arrays.append(force)
    return names, arrays


def _gyro(fit: Fit) -> Iterator[tuple[str, dict[str, Array]]]:
    """Errors of a gyro that go with the motion, where a heading says so: names, and additions to its readings, shape (n,), by channel."""
    log, p = fit.noise.predictor.log, fit.states.points
    if log.psi is None or log.turned:
        return
    n = log.n
    r = p.nu[2, :n]
    ahead, sideways = fit.states.specific[:2, :n]
    size = float(np.abs(r).max())
    wrong = {
        "the acceleration ahead": SHARE * ahead,
        "the acceleration sideways": SHARE * sideways,
        "its size": SHARE * np.abs(r),
        "its square": SHARE * r * np.abs(r) / max(size, 1e-9),
        "the time": SHARE * r * np.linspace(0.0, 1.0, n),
        "its delay": SHARE * fit.states.nudot[2, :n],
    }
    yield from ((f"{CHANNELS[2]}|{WRONG} {by}", {"r": x}) for by, x in wrong.items())


def _accelerometer(fit: Fit) -> Iterator[tuple[str, dict[str, Array]]]:
    """Errors of an accelerometer that go with the motion, as a scale that is off: names, and additions to its readings, shape (n,), by channel."""
    log = fit.noise.predictor.log
    felt = fit.states.specific[:2, : log.n]
    shaken = dict(_shaken(fit))
    for k, q in enumerate(("ax", "ay")):
        if log.acceleration[k] is not None:
            wrong = {"its scale": felt[k], "its size": np.abs(felt[k]), "the other axis": felt[1 - k], **shaken}
            yield from ((f"{CHANNELS[k]}|{FELT} {by}", {q: SHARE * x}) for by, x in wrong.items())


def _shaken(fit: Fit) -> Iterator[tuple[str, Array]]:
    """Number of thrusters that run near each of some demands, shape (n,): at a revolution with which its mounting swings, an accelerometer has an offset."""
    predictor = fit.noise.predictor
    run = [not isinstance(t, KnownForce) for t in predictor.vehicle.thrusters]
    own = [np.abs(d) for d, turns in zip(predictor.propulsion.demands, run, strict=True) if turns]
    shares = [d[: predictor.log.n] / max(float(d.max()), 1e-300) for d in own]
    for j in range(1, SHAKEN + 1):
        near = sum((np.maximum(1.0 - np.abs(SHAKEN * x - j), 0.0) for x in shares), np.zeros(predictor.log.n))
        yield f"demands near {j / SHAKEN:.2g} of the largest", near


def _memories(fit: Fit, k: int) -> Iterator[tuple[str, Array]]:
    """Fading means of the model's acceleration along an axis, of unit size, shape (2 n,); surge's alone where yaw is left out, on which sway's depends."""
    log = fit.noise.predictor.log
    if k and fit.noise.left_out:
        return
    along = np.split(fit.states.nudot[k], 2)
    wave = float(np.sqrt(hull_length(fit.noise.predictor.vehicle) / GRAVITY))
    for times, name in zip(MEMORIES, (MEMORY, f"long {MEMORY}"), strict=True):
        decay = float(np.exp(-log.h / max(times * wave, LEAST_MEMORY * log.h)))
        faded = np.concatenate([decaying((1 - decay) * x, decay) for x in along])
        yield name, faded / max(float(np.sqrt(np.mean(faded**2))), 1e-9)


def _swings(fit: Fit, k: int) -> Iterator[tuple[str, Array]]:
    """Forces of liquids that swing in tanks, of unit size, shape (2 n,); those across the hull turn it as well, and none where yaw is left out.

    A free surface is to first order an oscillator that the hull's acceleration drives, q'' + 2 d w q' + w^2 q = a, and its force goes with q.
    """
    predictor = fit.noise.predictor
    if fit.noise.left_out:
        return
    along = np.split(fit.states.specific[min(k, 1)], 2)
    wave = float(np.sqrt(hull_length(predictor.vehicle) / GRAVITY))
    for times in SWINGS:
        period = times * wave
        if period < LEAST_PERIOD * predictor.log.h:
            continue
        pole = np.exp((-SWINGING + 1j * np.sqrt(1 - SWINGING**2)) * 2 * np.pi / period * predictor.log.h)
        top, below = np.array([[[1.0, 0.0, 0.0]]]), np.array([[1.0, -2 * pole.real, abs(pole) ** 2]])
        yield (
            f"{period:.2g} s swinging {MEMORY}",
            of_unit_size(np.concatenate([respond([x], top, below)[0] for x in along])),
        )


def _trails(fit: Fit) -> Iterator[tuple[str, tuple[Array, Array]]]:
    """Forces ahead and sideways of a body in tow, whose pull grows with the square of the speed, of unit size, shape (2 n,); none where yaw is left out.

    The angle between the cable and the hull grows with each turn and fades with the way: to first order a tractrix. The pull sideways turns the hull as well.
    """
    if fit.noise.left_out:
        return
    h, nu = fit.noise.predictor.log.h, fit.states.points.nu
    length = hull_length(fit.noise.predictor.vehicle)
    # Samples and steps fade by themselves.
    halves = np.split(nu, 2, axis=1)
    for lengths, name in zip(TRAILS, (f"trailing {MEMORY}", f"long trailing {MEMORY}"), strict=True):
        faded = [_fading(h * r, np.exp(-h * np.hypot(u, v) / (lengths * length))) for u, v, r in halves]
        angle, pull = np.concatenate(faded), nu[0] * np.abs(nu[0])
        ahead, sideways = pull * (1.0 - np.cos(angle)), pull * np.sin(angle)
        yield name, (of_unit_size(ahead), of_unit_size(sideways))


def _fading(x: Array, kept: Array) -> Array:
    """y_t = x_t + kept_t y_(t-1), at rest before the first sample, shape (n,)."""
    out, y = [], 0.0
    for a, b in zip(x.tolist(), kept.tolist(), strict=True):
        y = a + b * y
        out.append(y)
    return np.array(out)
