"""The table of functions in docs/arithmetic.md: complete beside IEEE 1788, each name there, and each one tested."""

import re
from pathlib import Path

import numpy as np

from ivsid import Interval, IntervalArray

ROOT = Path(__file__).parents[2]
# Clauses 9 and 10 of IEEE 1788-2015: required and recommended functions, forward and reverse, sets, numbers and relations.
STANDARD = """
neg add sub mul div recip sqr sqrt fma pown pow exp exp2 exp10 log log2 log10 sin cos tan asin acos atan atan2 sinh cosh tanh asinh acosh atanh
sign ceil floor trunc roundTiesToEven roundTiesToAway abs min max
rootn expm1 exp2m1 exp10m1 logp1 log2p1 log10p1 compoundm1 hypot rSqrt sinPi cosPi tanPi asinPi acosPi atanPi atan2Pi
sqrRev absRev pownRev sinRev cosRev tanRev coshRev mulRev mulRevToPair powRev1 powRev2 atan2Rev1 atan2Rev2
cancelMinus cancelPlus intersection convexHull inf sup mid rad wid mag mig
equal subset less precedes interior strictLess strictPrecedes disjoint overlap isEmpty isEntire isCommonInterval isSingleton isMember
numsToInterval textToInterval intervalToText intervalToExact newDec setDec decorationPart intervalPart isNaI sum sumAbs sumSquare dot
"""


def table():
    """Its rows: names of the standard, and those of Rust and of Python, each as words in backticks."""
    text = (ROOT / "docs" / "arithmetic.md").read_text().split("## Names")[1].split("## Rounding")[0]
    rows = [line.strip("|").split(" | ") for line in text.splitlines() if line.startswith("|")][2:]
    return [[cell.strip() for cell in row] for row in rows]


def words(cell):
    """The names in backticks, without the type or module before them; operators and calls with arguments are none."""
    names = [name.split("::")[-1].split(".")[-1].removesuffix("()") for name in re.findall(r"`([^`]+)`", cell)]
    return [name for name in names if re.fullmatch(r"[A-Za-z_]\w*", name)]


def standard_names(cell):
    return re.findall(r"[A-Za-z][A-Za-z0-9]*", cell.split("(")[0])


def test_every_function_of_the_standard_is_in_the_table():
    named = {name for row in table() for name in standard_names(row[0])}
    assert [name for name in STANDARD.split() if name not in named] == []


def test_every_name_of_rust_is_defined_and_tested():
    source = "\n".join(p.read_text() for p in sorted((ROOT / "crates/interval-core/src").rglob("*.rs")))
    tests = "\n".join(p.read_text() for p in sorted((ROOT / "tests/rust").rglob("*.rs")))
    defined, missing, untested = 0, [], []
    # Display of the standard library.
    given = {"to_string"}
    for row in table():
        names = standard_names(row[0]) if row[1] == "the same" else words(row[1])
        for name in (n for n in names if n not in given):
            defined += 1
            # A function, or the name that a macro makes one of.
            if not re.search(rf"\bfn {name}\b|^\s+{name}\b.*=>", source, re.MULTILINE):
                missing.append(name)
            if not re.search(rf"\b{name}\b", tests):
                untested.append(name)
    assert defined > 100 and missing == [] and untested == []


def test_every_name_of_python_is_there():
    found = 0
    for row in table():
        for cell in re.findall(r"`([^`]+)`", row[2]):
            name = cell.removesuffix("()")
            if not re.fullmatch(r"[A-Za-z_][\w.]*", name) or name == "str":
                continue
            found += 1
            own = name.split(".")[-1]
            places = (np,) if name.startswith("np.") else (Interval, IntervalArray, __builtins__)
            known = [own in p if isinstance(p, dict) else hasattr(p, own) for p in places]
            assert any(known), name
    assert found > 60
