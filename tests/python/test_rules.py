"""Rules of the diagnosis: each says what it measures and why, the page holds them all, and a refusal names the rule that fired."""

import math
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "docs"))
from rules import PAGE, STAGES, page

from ivsid.diagnosis.null.rule import Rule, first_refusal

EVERY = [r for rules in STAGES.values() for r in rules]


def rule(name, limit, *, least=True, asked=lambda _: True):
    said = "{value} of {limit}, {case}"
    return Rule(name, "s", "b", "w", "m", float, lambda _: limit, said, asked, least)


def test_the_page_is_made_of_the_rules():
    assert PAGE.read_text() == page()
    names = [r.name for r in EVERY]
    assert len(set(names)) == len(names) >= 20
    assert all(r.statistic and r.bound and r.why.endswith(".") and r.measured and r.said for r in EVERY)


def test_commands_that_measure_a_limit_exist():
    makefile = (Path(__file__).parents[2] / "Makefile").read_text()
    for command in {r.measured for r in EVERY if r.measured.startswith("make ")}:
        assert f"\n{command.removeprefix('make ')}:" in makefile, command


def test_a_rule_refuses_below_or_beyond_its_limit_and_what_is_no_number():
    least, most = rule("least", 2.0), rule("most", 2.0, least=False)
    for value, low, high in ((1.0, True, False), (2.0, False, False), (3.0, False, True), (math.nan, True, True)):
        assert [least.refuses(value) is not None, most.refuses(value) is not None] == [low, high]
    refusal = least.refuses(1.5, ["a", "b"])
    assert (refusal.rule, refusal.value, refusal.limit) == ("least", 1.5, 2.0)
    assert refusal.sentence == "1.5 of 2.0, 1.5" and refusal.beside == ("a", "b")
    assert rule("unasked", 2.0, asked=lambda _: False).refuses(1.0) is None


def test_the_first_rule_that_is_not_kept_is_the_refusal():
    rules = (rule("a", 1.0), rule("b", 3.0), rule("c", 5.0))
    assert first_refusal(rules, 4.0).rule == "c" and first_refusal(rules, 2.0).rule == "b"
    assert first_refusal(rules, 6.0) is None


@pytest.mark.parametrize("stage", STAGES)
def test_sentences_take_the_numbers_of_their_rule(stage):
    for r in STAGES[stage]:
        assert "{" not in r.said.replace("{value", "").replace("{limit", "").replace("{case", ""), r.name
