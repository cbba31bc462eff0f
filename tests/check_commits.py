"""Commit subjects of a branch: at most 72 characters, no full stop at the end, one change named.

``python tests/check_commits.py [FIRST]`` looks at the commits after FIRST, by default the one with which the rule began. An unpacked
archive or a shallow clone has no such history, and then there is nothing to check.
"""

from __future__ import annotations

import subprocess
import sys

# The rule began after this commit; older subjects stay as they are.
FIRST = "56bc4c5021b1377abfa27aa616742174866385fd"
LONGEST = 72
# Subjects that reached the shared history before the rule saw them: what others hold is not rewritten. The rule stands for every other.
LANDED = {"29b312fac94e": "76 characters"}


def faults(subject: str) -> list[str]:
    """The reasons for which a subject is refused."""
    found = []
    if len(subject) > LONGEST:
        found.append(f"{len(subject)} characters, at most {LONGEST} are allowed; move the reason into the body")
    if subject.rstrip() != subject or subject.endswith("."):
        found.append("a subject ends without a full stop or a space")
    if ";" in subject:
        found.append("a semicolon joins two changes; one commit makes one")
    return found


def git(*arguments: str) -> subprocess.CompletedProcess[str]:
    """One call of git in this checkout."""
    return subprocess.run(["git", *arguments], capture_output=True, text=True, check=False)


def main(first: str) -> int:
    """Prints each fault; the number of commits that have one and are not among ``LANDED``."""
    if git("cat-file", "-e", f"{first}^{{commit}}").returncode:
        print(f"commits: nothing checked, this history does not hold {first[:9]}")
        return 0
    listed = git("log", "--no-merges", "--format=%H%x09%s", f"{first}..HEAD").stdout.splitlines()
    bad = 0
    for line in listed:
        whole, _, subject = line.partition("\t")
        commit = whole[:12]
        found = [] if commit in LANDED else faults(subject)
        bad += bool(found)
        for fault in found:
            print(f"commit {commit} '{subject[:LONGEST]}': {fault}")
    print(f"commits: {len(listed)} subjects checked, {bad} refused")
    return bad


if __name__ == "__main__":
    sys.exit(1 if main(sys.argv[1] if len(sys.argv) > 1 else FIRST) else 0)
