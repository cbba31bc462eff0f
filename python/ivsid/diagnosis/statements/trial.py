"""Trial of the extended model on the other log: both models in forked processes, while TRAIN is still examined."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial

from ivsid.diagnosis.estimation.learning import determined, undetermined
from ivsid.diagnosis.plant.physics import Hypothesis
from ivsid.diagnosis.prediction.innovations import Predictor, replaced
from ivsid.diagnosis.selection.select import Selection
from ivsid.diagnosis.statements.comparison import Gain, compare
from ivsid.diagnosis.statements.share import Share, shares
from ivsid.diagnosis.statements.without import same_causes, without
from ivsid.intervals.apart import Apart


class Trial:
    """The extended model, and its comparison with the plain one.

    Attributes:
        model: the extended hypothesis, with the findings and nothing else.
        out: causes that were found and are no findings.
    """

    model: Hypothesis
    out: tuple[str, ...]

    def __init__(
        self,
        predictor: Predictor,
        selection: Selection,
        seed: int,
        tried: Callable[[Gain], None] = lambda _: None,
        out: Sequence[str] = (),
    ) -> None:
        """Starts the comparisons.

        Args:
            predictor: of the other log.
            selection: the causes with their fits.
            seed: of the bootstrap.
            tried: told of the gain once, as soon as it is asked for after it is known.
            out: causes that were found and are no findings.
        """
        self.out = tuple(out)
        self._given = (predictor, selection, seed, tried)
        self._known: Gain | None = None
        plain, last = selection.plain, selection.last
        extended = without(plain, last, out).h
        # Errors of TRAIN's sensors and thrusters are no part of the model: TEST has its own.
        before = replace(determined(plain), declared_errors={})
        known = replaced(extended, undetermined(last))
        # Numbers that were fitted anew beside the same causes are no other model.
        self.model = before if same_causes(extended, plain.h) else replace(known, declared_errors={})
        self._gain = Apart(partial(compare, predictor, before, self.model, seed))
        causes = [f.id for f in selection.found]
        self._shares = Apart(partial(shares, predictor, plain, last, causes, out)) if causes else None

    def of(self, names: Collection[str]) -> Trial:
        """The trial of the model with these findings; this one, if it has no other causes."""
        _, selection, _, _ = self._given
        out = tuple(f.id for f in selection.found if f.id not in names)
        if out == self.out:
            return self
        self._gain.end()
        if self._shares is not None:
            self._shares.end()
        return Trial(*self._given, out)

    def look(self) -> None:
        """Tells of the gain if it is known by now."""
        if self._gain.done:
            self._told()

    def _told(self) -> Gain:
        if self._known is None:
            self._known = self._gain.result()
            self._given[-1](self._known)
        return self._known

    def result(self) -> tuple[Gain, Mapping[str, Share]]:
        """Gain on the other log, and shares of the causes in its error in position, by id."""
        return self._told(), {} if self._shares is None else self._shares.result()
