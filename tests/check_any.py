"""The number of times that the package says ``Any``, against a ceiling that only falls.

``python tests/check_any.py`` counts the name in python/ivsid (imports left out). Above the ceiling, or below it, the check fails: a lower
count has to be written down here, so that it stays.
"""

from __future__ import annotations

import sys
import tokenize
from collections import Counter
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[1] / "python" / "ivsid"
CEILING = 114


def mentions(path: Path) -> int:
    """How often a file says ``Any``, without its imports."""
    with path.open("rb") as file:
        tokens = list(tokenize.tokenize(file.readline))
    imported = {t.start[0] for t in tokens if t.string in ("import", "from") and t.type == tokenize.NAME}
    return sum(t.type == tokenize.NAME and t.string == "Any" and t.start[0] not in imported for t in tokens)


def main() -> int:
    """Prints the count by chapter; 0 where it is the ceiling."""
    found: Counter[str] = Counter()
    for path in PACKAGE.rglob("*.py*"):
        if path.suffix in (".py", ".pyi"):
            found[path.relative_to(PACKAGE).parts[0]] += mentions(path)
    total = sum(found.values())
    print(f"Any: {total}, ceiling {CEILING}; most in " + ", ".join(f"{k} {n}" for k, n in found.most_common(5)))
    if total > CEILING:
        print("use a concrete type; Any belongs to the edges where raw files enter")
    if total < CEILING:
        print(f"lower CEILING in {Path(__file__).name} to {total}")
    return int(total != CEILING)


if __name__ == "__main__":
    sys.exit(main())
