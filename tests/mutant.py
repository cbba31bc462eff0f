"""One named fault, for the lists of ``mutants.py``."""

from __future__ import annotations

from dataclasses import dataclass

STATED = "test_stated_bounds.py"
CORE = "crates/interval-core/src"


@dataclass(frozen=True)
class Mutant:
    """A fault: ``old`` stands ``count`` times in ``file``, and becomes ``new``; ``tests`` are files of pytest, or of Cargo for the core."""

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    count: int = 1

    @property
    def rust(self) -> bool:
        """Whether it is one of the core."""
        return self.file.endswith(".rs")


def python(name: str, file: str, old: str, new: str, *tests: str, count: int = 1) -> Mutant:
    """A mutant of the package."""
    return Mutant(name, f"python/ivsid/{file}", old, new, tests or (STATED,), count)


def rust(name: str, file: str, old: str, new: str, *tests: str, count: int = 1) -> Mutant:
    """A mutant of the core."""
    return Mutant(name, f"{CORE}/{file}", old, new, tests, count)
