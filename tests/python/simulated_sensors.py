"""Static sensors from known noise, written apart from the package: recursions from their definitions, filters from SciPy's design."""

from dataclasses import dataclass

import numpy as np
from scipy import signal


@dataclass(frozen=True)
class Sensor:
    """Noise of a sensor: white N, bias B of correlation time T, walk K, flicker F, then a low-pass filter, then steps."""

    n: float = 0.0
    b: float = 0.0
    t: float = 1.0
    k: float = 0.0
    flicker: float = 0.0
    order: int = 0
    cutoff: float = 0.0
    step: float = 0.0

    def white(self, dt):
        """The density of the white part after filter and steps; rounding adds step^2 / 12 a sample (Widrow)."""
        return float(np.sqrt(self.n**2 + self.step**2 / 12 * dt))

    def record(self, samples, dt, rng):
        warm = 4000 if self.order else 0
        size = samples + warm
        x = rng.standard_normal(size) * self.n / np.sqrt(dt)
        if self.b:
            keep = np.exp(-dt / self.t)
            drive = rng.standard_normal(size) * self.b * np.sqrt(1 - keep**2)
            drive[0] = rng.standard_normal() * self.b
            x += signal.lfilter([1.0], [1.0, -keep], drive)
        if self.k:
            x += np.cumsum(rng.standard_normal(size)) * self.k * np.sqrt(dt)
        if self.flicker:
            x += flicker(size, self.flicker, dt, rng)
        if self.order:
            x = signal.lfilter(*signal.butter(self.order, self.cutoff, fs=1 / dt), x)
        x = x[warm:]
        return np.round(x / self.step) * self.step if self.step else x


def flicker(samples, coefficient, dt, rng):
    """Flicker noise of two-sided spectrum F^2 / (2 pi f), drawn in the frequency domain over twice the record."""
    f = np.fft.rfftfreq(2 * samples, dt)[1:]
    amplitude = np.sqrt(coefficient**2 / (2 * np.pi * f) * 2 * samples / dt / 2)
    spectrum = (rng.standard_normal(f.size) + 1j * rng.standard_normal(f.size)) * amplitude
    return np.fft.irfft(np.r_[0, spectrum], 2 * samples)[:samples]


def drawn(seed):
    """A sensor of any of the kinds: no filter, first or second order; steps or none; bias, walk, both or neither."""
    rng = np.random.default_rng([seed, 7])
    slow = seed % 4
    n = 2e-3 * 4 ** rng.uniform(-0.5, 0.5)
    order = (seed // 4) % 3
    cutoff = 50.0 * 10 ** rng.uniform(-1.0, -0.3)
    # Behind the filter the noise at a sample is about sqrt(pi cutoff / 2) N, or sqrt(50) N without one.
    sample = n * np.sqrt(np.pi / 2 * cutoff if order else 50.0)
    return Sensor(
        n=n,
        b=n * rng.uniform(0.7, 2.0) if slow in (1, 3) else 0.0,
        t=rng.uniform(4.0, 12.0),
        k=n * rng.uniform(0.03, 0.1) if slow in (2, 3) else 0.0,
        order=order,
        cutoff=cutoff,
        step=sample * rng.uniform(0.5, 1.5) if (seed // 12) % 2 else 0.0,
    )
