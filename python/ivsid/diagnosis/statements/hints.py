"""Hints: structure that declared errors explain inside their bounds, in sentences. A hint is no finding."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np

from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.null.boxed import OVERSHOOT, outside
from ivsid.diagnosis.plant.declared_readings import DEVIATION, PARTS, assumed, bounded, deviation_shapes
from ivsid.diagnosis.statements.sensor_words import WORDS
from ivsid.effects import CHANNELS
from ivsid.vehicle import KnownForce

# A declared error is mentioned if its size exceeds this multiple of the standard deviation of its estimate.
# Source: definition: 6e-7 of normal errors lie beyond
SHOWN: Final = 5.0
# An ambient force is mentioned if its rms exceeds this multiple of the declared force.
# Source: measured: make constants
STRONGER: Final = 2.0
# Standard deviations of a bias without a bound up to which it is said to be inside its specification.
# Source: definition: its stated instability is one standard deviation, of which 99.7 % lie within three
SPECIFIED: Final = 3.0
# Headings round the compass at which its deviation is looked at.
# Source: definition: whole degrees
HEADINGS: Final = 360


def hints(fit: Fit) -> tuple[str, ...]:
    """Sentences on biases, scale factors and thrust errors that the log shows inside their bounds, and on a strong ambient force."""
    g, p = fit.gram, fit.projection
    out: list[str] = []
    predictor = fit.noise.predictor
    inside_of = bounded(predictor.vehicle, earth=predictor.log.earth)
    bounds = {name: float(np.abs(turn[0]).sum()) for name, _, turn in inside_of}
    out += _compass(fit)
    for i, k in enumerate(p.base):
        name = g.names[k]
        if not name.startswith("~") or name.startswith(("~thrust", "~hysteresis", "~rudder")):
            continue
        size = fit.h.declared_errors.get(name, 0.0)
        sigma = float(np.sqrt(p.covariance[i, i])) / float(g.unit[k])
        if abs(size) < SHOWN * sigma:
            continue
        if name == "~scale.velocity":
            stated = fit.noise.predictor.vehicle.sensors.velocity
            bound = 0.0 if stated is None else 100 * stated.scale_factor_error
            out.append(
                f"velocities read {100 * size:+.2f} % of their value too much; the vehicle file allows for {bound:.3g} %"
            )
        elif (whole := name.removesuffix(".0")) in WORDS and not assumed(fit.noise.predictor.vehicle, whole):
            said = WORDS[whole]
            inside = abs(size) <= bounds.get(whole, SPECIFIED / float(np.sqrt(g.prior[k])) / float(g.unit[k]))
            where = "inside its specification" if inside else "more than its specification allows for"
            out.append(f"the {said.name} is about {size:.3g} {said.unit}, {where}")
    far = dict(outside(fit))
    for thruster in fit.noise.predictor.vehicle.thrusters:
        own = [g.names[k] for k in p.base if g.names[k].startswith(f"~thrust.{thruster.name}.")]
        if _shown(fit, own):
            most = far.get(thruster.name, 0.0)
            where = (
                f"as estimated by up to {most:.1f} times its accuracy, and one inside it fits as well unless a finding says otherwise"
                if most > OVERSHOOT
                else "inside its accuracy"
            )
            what = "differs" if isinstance(thruster, KnownForce) else "differs from its curve"
            out.append(f"{thruster.words} {what}, {where}")
    vehicle, ambient = fit.noise.predictor.vehicle, fit.noise.predictor.ambient
    if vehicle.ambient is not None and vehicle.ambient.force:
        mass = np.linalg.inv(fit.signatures.mass.inverse[0])
        force = [ambient.deviation[k] * mass[k, k] for k in range(2)]
        strong = [k for k, x in enumerate(force) if x > STRONGER * vehicle.ambient.force]
        # Both axes feel one sea; a force in one of them alone may be another one.
        where = f" in {CHANNELS[strong[0]]}" if len(strong) == 1 else ""
        pushed = (
            "thrusts that are off inside their accuracies, or "
            if not any(isinstance(t, KnownForce) for t in vehicle.thrusters)
            else "known forces that are off, or "
        )
        if strong:
            out.append(
                f"the ambient force{where} looks like {min(force[k] for k in strong):.2g} N rms, more than the {vehicle.ambient.force:g} N of the vehicle file"
                f"{f': {pushed}a force that the model lacks, may be part of it' if where else ''}"
            )
    return tuple(out)


def _shown(fit: Fit, own: Sequence[str]) -> bool:
    """Whether declared errors of a base, taken together, exceed what chance makes of their estimates."""
    g, p = fit.gram, fit.projection
    at = [i for i, k in enumerate(p.base) if g.names[k] in own]
    if not at:
        return False
    sizes = np.array([fit.h.declared_errors.get(g.names[p.base[i]], 0.0) * g.unit[p.base[i]] for i in at])
    return float(sizes @ np.linalg.solve(p.covariance[np.ix_(at, at)], sizes)) > SHOWN**2 + len(at)


def _compass(fit: Fit) -> tuple[str, ...]:
    """A sentence on the deviation of the compass, where the log shows one."""
    heading = fit.noise.predictor.vehicle.sensors.heading
    if heading is None or not _shown(fit, tuple(PARTS)):
        return ()
    psi = np.linspace(-np.pi, np.pi, HEADINGS, endpoint=False)
    sizes = [fit.h.declared_errors.get(name, 0.0) for name in PARTS]
    error = np.abs(sizes @ np.stack(deviation_shapes(psi)))
    largest, at = float(error.max()), np.degrees(psi[int(error.argmax())]) % 360.0
    said, inside = WORDS[DEVIATION], largest <= OVERSHOOT * heading.accuracy
    where = "inside its specification" if inside else "more than its specification allows for"
    return (f"the {said.name} reaches {largest:.2g} {said.unit} on a heading of {at:.0f} deg, {where}",)
