"""What a programme is good for: one number that is to be small, and how it reads."""

from __future__ import annotations

from typing import Protocol

from ivsid.plans.sailed import Sailed


class Purpose(Protocol):
    """A purpose of a plan.

    Attributes:
        name: ``narrow`` or ``separate``.
        quantity: what the number is, in words.
        larger: whether a larger value is better.
    """

    name: str
    quantity: str
    larger: bool

    def value(self, sailed: Sailed) -> float:
        """The quantity after the programme; infinite (or 0, where larger is better) where the log says nothing."""
        ...

    def cost(self, sailed: Sailed) -> float:
        """What the search makes small: the quantity, and what breaks a tie."""
        ...

    def details(self, sailed: Sailed) -> dict[str, object]:
        """What result.json holds beside the value."""
        ...
