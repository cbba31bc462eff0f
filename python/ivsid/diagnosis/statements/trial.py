"""Trial of the extended model on the other log: both models in forked processes, while TRAIN is still examined."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial

from ivsid.diagnosis.data.channels import Channels
from ivsid.diagnosis.estimation.fit import Fit
from ivsid.diagnosis.estimation.learning import determined, undetermined
from ivsid.diagnosis.estimation.other_log import SHARED
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.statements.comparison import Gain, compare
from ivsid.diagnosis.statements.share import Share, shares
from ivsid.diagnosis.statements.without import same_causes, without
from ivsid.intervals.apart import Apart


def unchanged(other: Channels, plain: Fit, seed: int) -> Gain:
    """The comparison where no cause is found: the plain model with itself.

    Args:
        other: the other log on its clock.
        plain: fit of the model without causes.
        seed: of the bootstrap.
    """
    before = _as_it_was(plain)
    return compare(_on(other, plain), before, before, seed)


def _as_it_was(plain: Fit) -> Hypothesis:
    """The plain model without errors of TRAIN's sensors and thrusters, which are no part of it: TEST has its own."""
    return replace(determined(plain), declared_errors={})


def _with(h: Hypothesis, errors: Mapping[str, float]) -> Hypothesis:
    """A hypothesis with those declared errors that are the vehicle's and no log's."""
    return replace(h, declared_errors={k: x for k, x in errors.items() if k.startswith(SHARED)})


def _on(other: Channels, fit: Fit) -> Predictor:
    """Predictions of the other log beside the ambient force of a fit."""
    here = fit.noise.predictor
    return Predictor(here.vehicle, other, here.ambient)


class Trial:
    """The extended model, and its comparison with the plain one.

    Attributes:
        model: the extended hypothesis, with the findings and nothing else.
        out: causes that were found and are no findings.
        beside: the comparison with the thrust errors that TRAIN shows, where it was asked for.
    """

    model: Hypothesis
    out: tuple[str, ...]
    beside: Gain | None

    def __init__(
        self,
        other: Channels,
        selection: Selection,
        seed: int,
        tried: Callable[[Gain], None],
        nothing: Apart[Gain],
        out: Sequence[str] = (),
    ) -> None:
        """Starts the comparisons.

        Args:
            other: the other log on its clock.
            selection: the causes with their fits.
            seed: of the bootstrap.
            tried: told of the gain once, as soon as it is asked for after it is known.
            nothing: the comparison where no cause was found, begun before any was looked for; its process goes on with other tasks.
            out: causes that were found and are no findings.
        """
        self.out, self.beside = tuple(out), None
        self._other, self._selection, self._tried, self._seed = other, selection, tried, seed
        self._again = partial(Trial, other, selection, seed, tried, nothing)
        self._known: Gain | None = None
        plain, last = selection.plain, selection.last
        extended = without(plain, last, out).h
        before = _as_it_was(plain)
        known = replaced(extended, undetermined(last))
        # Numbers that were fitted anew beside the same causes are no other model.
        self.model = before if same_causes(extended, plain.h) else replace(known, declared_errors={})
        causes = [f.id for f in selection.found]
        self._shares: Apart[Mapping[str, Share]] | None = None
        self._gain = nothing
        if causes:
            nothing.drop()
            predictor = _on(other, last)
            self._gain = Apart(partial(compare, predictor, before, self.model, seed))
            self._shares = Apart(partial(shares, predictor, plain, last, causes, out))

    def of(self, names: Collection[str]) -> Trial:
        """The trial of the model with these findings; this one, if it has no other causes."""
        out = tuple(f.id for f in self._selection.found if f.id not in names)
        if out == self.out:
            return self
        self._gain.end()
        if self._shares is not None:
            self._shares.end()
        return self._again(out)

    def with_thrusts(self) -> Gain:
        """The comparison in which both models keep the thrust errors that TRAIN shows of them: the thrusters are the same on the other log.

        A model without a cause lets drags take such errors, too, and loses less without them than the right model does.
        """
        plain, last = self._selection.plain, self._selection.last
        shown = without(plain, last, self.out).h.declared_errors
        before, model = _with(_as_it_was(plain), plain.h.declared_errors), _with(self.model, shown)
        self.beside = compare(_on(self._other, last), before, model, self._seed)
        return self.beside

    def look(self) -> None:
        """Tells of the gain if it is known by now; where no cause is found it was asked for before all else that is waited for."""
        if self._gain.done or self._shares is None:
            self._told()

    def _told(self) -> Gain:
        if self._known is None:
            self._known = self._gain.result()
            self._tried(self._known)
        return self._known

    def result(self) -> tuple[Gain, Mapping[str, Share]]:
        """Gain on the other log, and shares of the causes in its error in position, by id."""
        return self._told(), {} if self._shares is None else self._shares.result()
