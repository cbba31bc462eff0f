"""Readings against the tubes of a fit: motion that no consistent vehicle makes, where each row alone may agree."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from ivsid.errors import IvsidError
from ivsid.identification import Identification
from ivsid.log import Log
from ivsid.tubes.bounds import tube
from ivsid.tubes.equations import Equations, equations_of
from ivsid.tubes.horizons import Horizon
from ivsid.tubes.refuted import Refutation

# Windows [s] beside the whole log: a late reading shows in a short one, a small lasting force in a long one.
# Source: definition: the rows of two samples and the windows of simulated velocities lie a factor of ten around them
WINDOWS: Final = (1.0, 10.0)
# Rows up to which the tubes are followed without being asked for.
# Source: resource: some seconds, at about 20 us a step of each of the three tubes
UNASKED: Final = 100_000
# Channels in the order in which they are tried: those that follow more refute more, and need finite intervals of more parameters.
FOLLOWED: Final = ("all", "surge")
# Steps in short windows by which it is asked whether a tube of all channels lasts.
# Source: resource: a step that fails is cut into 64 parts first, which takes as long as a thousand that hold
PROBE: Final = 100
# Share of these steps that such a tube has to prove.
# Source: definition: a tube that ends before the middle of its windows bounds fewer readings than one of fewer channels
LASTING: Final = 0.5


@dataclass(frozen=True)
class TubeCheck:
    """Readings against the tubes of every consistent vehicle.

    Attributes:
        channels: ``all``, or ``surge`` where the fit leaves other parameters open; empty where no tube was followed.
        outside: number of rows with a reading outside, by length of the windows [s]; None stands for the whole log.
        refuted: the first reading outside of each length, each over the shortest window that shows it.
        guaranteed: whether a reading outside proves the fit wrong under ``assumes``.
        assumes: sentences that it relies on beside those of the fit.
        reason: obstacle to any tube, or None.
    """

    channels: str
    outside: dict[float | None, int]
    refuted: tuple[Refutation, ...]
    guaranteed: bool
    assumes: tuple[str, ...]
    reason: str | None

    @property
    def clearest(self) -> Refutation | None:
        """The refutation over the shortest window; None without any."""
        return min(self.refuted, key=lambda f: f.rows[1] - f.rows[0], default=None)

    def record(self) -> dict[str, object]:
        """The entry ``tubes`` of result.json."""
        return {
            "channels": self.channels,
            "outside": {"whole" if k is None else f"{k:g} s": n for k, n in self.outside.items()},
            "refuted": [f.record() for f in self.refuted],
            "guaranteed": self.guaranteed,
            "assumes": list(self.assumes),
            "reason": self.reason,
        }


def reached(
    fit: Identification,
    log: Log,
    *,
    windows: Sequence[float] = WINDOWS,
    whole: bool = True,
    steps: int | None = None,
    asked: bool | None = None,
    equations: dict[str, Equations] | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> TubeCheck:
    """Follows the tubes of a fit under the demands of a log, and looks for readings outside (docs/theory.md, "Guaranteed simulation").

    Args:
        fit: by ``identify``.
        log: a checked log.
        windows: lengths [s] of windows that restart from the measured state.
        whole: whether the log is followed without restarts as well.
        steps: of all windows of one length together, at most; None follows all.
        asked: whether tubes are followed; None follows those of at most ``UNASKED`` rows.
        equations: of the fit by channels, which several logs share; those that are missing are added.
        progress: told of each step.
    """
    if asked is False:
        return _none("tubes were not asked for")
    if asked is None and log.t.size > UNASKED:
        return _none(f"{log.t.size} rows take long; ask for tubes, or follow them with ivsid tube")
    obstacles: list[str] = []
    known = {} if equations is None else equations
    for channels in FOLLOWED:
        try:
            if channels not in known:
                known[channels] = equations_of(fit, (True, channels == "all", channels == "all"))
            follow = partial(
                tube,
                fit,
                log,
                channels=channels,
                inner=False,
                early=True,
                examine=False,
                equations=known[channels],
                progress=progress,
            )
            if windows and channels != FOLLOWED[-1]:
                probe = follow(windows=(min(windows),), whole=False, steps=PROBE).runs[0].horizon
                if _proved(probe) < LASTING:
                    obstacles.append(f"the intervals of this fit are too wide for a tube of {channels} channels")
                    continue
            found = follow(windows=windows, whole=whole, steps=steps)
        except IvsidError as error:
            obstacles.append(str(error))
            continue
        return TubeCheck(
            channels,
            {r.horizon.length: r.outside for r in found.runs},
            tuple(f for r in found.runs for f in r.refuted),
            found.guaranteed,
            tuple(a for a in found.assumes if a not in fit.assumes),
            None,
        )
    return _none("; ".join(dict.fromkeys(obstacles)))


def _proved(horizon: Horizon) -> float:
    """Share of the steps of some windows that their tubes hold to the end."""
    followed = sum(w.last - w.first for w in horizon.windows)
    return sum(w.proved - w.first for w in horizon.windows) / max(followed, 1)


def _none(reason: str) -> TubeCheck:
    return TubeCheck("", {}, (), False, (), reason)
