"""The page docs/rules.md: every rule of the diagnosis, in the order in which the rules are asked.

``python docs/rules.py`` writes the page from the rule objects themselves.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from ivsid.diagnosis.null.rule import Rule
from ivsid.diagnosis.null.screening import SCREENING
from ivsid.diagnosis.selection.rules import FULL_FITS, LATE
from ivsid.diagnosis.selection.verdict import VERDICT
from ivsid.diagnosis.statements.carried import CARRIES, STAYS
from ivsid.diagnosis.statements.rules import HELD, UNNAMED

PAGE: Final = Path(__file__).with_name("rules.md")
STAGES: Final[dict[str, Sequence[Rule[Any]]]] = {
    "Screening, by the scores": SCREENING,
    "Where several causes were found already": LATE,
    "Full fits": FULL_FITS,
    "Verdict": VERDICT,
    "Findings": (*HELD, UNNAMED, STAYS, CARRIES),
}
HEAD: Final = """# Rules

A cause is a finding if it keeps every rule of causes below, and a model without findings is adequate if it keeps those of the verdict. The
rules are objects of the package, and `make rules-page` writes this page from them.
A cause that is refused carries the first rule that it did not keep: `rejected` in result.json has the rule's name, the statistic, the limit
and the sentence.
"""


def page() -> str:
    """The page as Markdown: a table for each stage."""
    out = [HEAD]
    for stage, rules in STAGES.items():
        out.append(f"\n## {stage}\n\n| rule | statistic | limit | reason | limit from |\n|---|---|---|---|---|\n")
        for r in rules:
            cells = (r.name, r.statistic, r.bound, r.why, r.measured)
            out.append("| " + " | ".join(x.replace("|", "\\|") for x in cells) + " |\n")
    return "".join(out)


if __name__ == "__main__":
    PAGE.write_text(page())
