"""The distance of two causes by a planned log: the square root of the fall of chi-squared that is lost where one is taken for the other.

Source: docs/theory.md, "Isolability".
"""

from __future__ import annotations

from ivsid.diagnosis import isolability
from ivsid.effects import EFFECTS
from ivsid.errors import IvsidError, meant
from ivsid.identification import Identification
from ivsid.plans.sailed import Sailed


class Separation:
    """The smaller of both distances of two causes of typical size.

    Args:
        fit: by ``identify``.
        causes: two ids of the catalogue.

    Raises:
        IvsidError: an unknown cause, or the same one twice.
    """

    name = "separate"
    quantity = "distance of the causes"
    larger = True

    def __init__(self, fit: Identification, causes: tuple[str, str]) -> None:
        for id_ in causes:
            if id_ not in EFFECTS:
                raise IvsidError(f"cause '{id_}' is unknown; {meant(id_, tuple(EFFECTS))}ivsid effects lists all")
        if causes[0] == causes[1]:
            raise IvsidError(f"'{causes[0]}' was given twice; two causes are needed to tell them apart")
        self.vehicle, self.causes = fit.vehicle, causes

    def value(self, sailed: Sailed) -> float:
        """The distance; 0 where the log cannot be diagnosed, or shows one of them not at all."""
        try:
            found = isolability(self.vehicle, sailed.log, wanted=self.causes)
        except IvsidError:
            return 0.0
        if not set(self.causes) <= set(found.ids):
            return 0.0
        a, b = (found.ids.index(c) for c in self.causes)
        return float(min(found.distance[a, b], found.distance[b, a]))

    def cost(self, sailed: Sailed) -> float:
        """The distance, negative."""
        return -self.value(sailed)

    def details(self, sailed: Sailed) -> dict[str, object]:
        """What each cause shows by itself: z at its typical size."""
        try:
            found = isolability(self.vehicle, sailed.log, wanted=self.causes)
        except IvsidError as error:
            return {"reason": str(error)}
        return {c: found.visible[c].z for c in self.causes if c in found.visible}
