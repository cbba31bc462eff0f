"""What an Allan analysis says in words and in the units of data sheets, and the vehicle file that follows from it."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import Final

from ivsid.files import units
from ivsid.sensors.allan import AllanDeviation
from ivsid.workflow.allan_recording import Channel

# Units of data sheets: random walk and bias instability of each quantity, with their SI values.
# Source: definition: IEEE Std 952-1997 and IEEE Std 1293-1998, units of their coefficients.
DATA_SHEET: Final = {
    "yaw_rate": ("deg/√h", units.RATE["deg/s"] / 60.0, "deg/h", units.RATE["deg/h"]),
    "acceleration": ("µg/√Hz", units.ACCELERATION["mg"] / 1e3, "µg", units.ACCELERATION["mg"] / 1e3),
}


def allan_notes(a: AllanDeviation, unit: str) -> list[str]:
    """The signs of more than noise in a channel, one sentence each."""
    found, who = a.signs, f"channel {a.channel}"
    moved = a.motion is not None or not a.explained
    notes = []
    if a.start > a.period * 1.5:
        cause = (
            f"a low-pass filter of the sensor, which halves the power at about {found.bandwidth:.3g} Hz"
            if found.bandwidth and not moved
            else "a filter of the sensor, steps of its readings or a motion"
        )
        notes.append(
            f"{who}: averaging times below {a.start:.3g} s are left out of the fit, because {cause}, shapes them"
        )
    elif found.bandwidth and not moved:
        notes.append(f"{who}: a low-pass filter of the sensor halves the power at about {found.bandwidth:.3g} Hz")
    if a.coarse:
        notes.append(
            f"{who}: the readings stand on steps of {found.step:.3g} {unit}, which are larger than the noise: half a step counts as accuracy"
        )
    if found.sinusoid:
        frequency, amplitude = found.sinusoid
        notes.append(
            f"{who}: a sinusoid of {frequency:.4g} Hz and amplitude {amplitude:.3g} {unit} stands in the recording, so the sensor was not at rest "
            f"(swell, vibration, mains): averaging times about {0.5 / frequency:.3g} s show it, and no noise"
        )
    elif a.motion:
        notes.append(
            f"{who}: the curve has a hump of a motion to and fro at about {a.motion:.2g} Hz, so the sensor was not at rest (swell, vibration): N "
            "counts from shorter averaging times, B and T hold this motion"
        )
    if found.drift is not None:
        notes.append(
            f"{who}: the reading drifts by {found.drift:.3g} {unit} over the recording, as with temperature: B, T and K hold this drift; record "
            "once the sensor is warm"
        )
    if not a.explained:
        notes.append(
            f"{who}: the curve has another shape than the fitted noise, beyond chance: the bands are widened by the misfit"
        )
    if a.flicker:
        notes.append(
            f"{who}: the bias is flicker noise of coefficient B, without a correlation time of its own; the vehicle file takes its standard "
            f"deviation over the recording, {a.bias_bound:.3g} {unit}"
        )
    return notes


def data_sheet_rows(curves: Mapping[str, AllanDeviation], channels: Mapping[str, Channel]) -> list[list[object]]:
    """Random walk and bias instability (floor / 0.664) of each channel as a data sheet gives them."""
    rows: list[list[object]] = []
    for name, a in curves.items():
        channel = channels[name]
        if channel.quantity in DATA_SHEET:
            walk, walk_unit, floor, floor_unit = (DATA_SHEET[channel.quantity][k] for k in (0, 1, 2, 3))
            n, f = a.random_walk * channel.factor, a.floor * channel.factor
            rows.append([name, f"{n / float(walk_unit):.4g} {walk}", f"{f / float(floor_unit):.4g} {floor}"])
    return rows


def sensors_toml(curves: Mapping[str, AllanDeviation], channels: Mapping[str, Channel]) -> str:
    """The sensor sections of a vehicle file, in SI; it has no place for an accelerometer's z axis and a gyro's x and y axes."""
    lines: list[str] = []
    by = {q: [a for n, a in curves.items() if channels[n].quantity == q] for q in ("acceleration", "yaw_rate")}
    level = [a for a in by["acceleration"] if not re.search(r"z", _axis(a.channel))][:2]
    rates = by["yaw_rate"]
    yaw = next((a for a in rates if re.search(r"(^r\b|z)", _axis(a.channel))), rates[-1] if rates else None)
    for section, found in (("acceleration", level), ("yaw_rate", [yaw] if yaw else [])):
        if found:
            factors = [channels[a.channel].factor for a in found]
            given = sorted({channels[a.channel].unit for a in found} - {"rad/s", "m/s^2"})
            lines += [
                f"[sensors.{section}]  # from {', '.join(a.channel for a in found)}"
                + (f", whose unit is {', '.join(given)}" if given else ""),
                f"random_walk = {_pair([f * a.white_bound for a, f in zip(found, factors, strict=True)])}",
                f"bias_instability = {_pair([f * a.bias_bound for a, f in zip(found, factors, strict=True)])}",
                f"bias_time = {_pair([a.bias_time for a in found])}",
            ]
            walk = max(f * a.rate_random_walk for a, f in zip(found, factors, strict=True))
            lines += [f"rate_random_walk = {walk:.4g}"] if walk else []
            steps = [0.5 * f * a.signs.step for a, f in zip(found, factors, strict=True) if a.coarse and a.signs.step]
            lines += [f"accuracy = {max(steps):.4g}  # half a step of the readings"] if steps else []
            lines.append("")
    return "\n".join(lines)


def _axis(name: str) -> str:
    return name.split("_", 1)[-1] if "_" in name else name


def _pair(values: Sequence[float]) -> str:
    numbers = [f"{v:.4g}" for v in values]
    return numbers[0] if len(numbers) == 1 else f"[{', '.join(numbers)}]"


def half_width(a: AllanDeviation, sigmas: float, duration: float) -> float:
    """Half-width that every sample of a log of this duration [s] keeps, in the channel's unit."""
    noise = a.white_bound / math.sqrt(a.period) + a.bias_bound + a.rate_random_walk * math.sqrt(duration)
    return sigmas * noise + (0.5 * a.signs.step if a.coarse and a.signs.step else 0.0)
