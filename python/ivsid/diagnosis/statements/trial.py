"""Trial of the extended model on the other log: both models in forked processes, while TRAIN is still examined."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
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

    def __init__(self, predictor: Predictor, selection: Selection, seed: int, out: Sequence[str] = ()) -> None:
        """Starts the comparisons.

        Args:
            predictor: of the other log.
            selection: the causes with their fits.
            seed: of the bootstrap.
            out: causes that were found and are no findings.
        """
        self.out = tuple(out)
        self._given = (predictor, selection, seed)
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
        predictor, selection, seed = self._given
        out = tuple(f.id for f in selection.found if f.id not in names)
        if out == self.out:
            return self
        self._gain.end()
        if self._shares is not None:
            self._shares.end()
        return Trial(predictor, selection, seed, out)

    def result(self) -> tuple[Gain, Mapping[str, Share]]:
        """Gain on the other log, and shares of the causes in its error in position, by id."""
        return self._gain.result(), {} if self._shares is None else self._shares.result()
