"""The lines that ``make mutants`` edits stand in the tree: a mutant whose line has moved kills nothing and says so only at night."""

from tests.mutants import MUTANTS, ROOT


def test_each_named_fault_finds_its_line():
    lost = [m.name for m in MUTANTS if (ROOT / m.file).read_text().count(m.old) != m.count]
    assert MUTANTS and lost == []


def test_each_named_fault_changes_its_line_and_names_tests_that_exist():
    for m in MUTANTS:
        assert m.old != m.new, m.name
        folder, ending = (ROOT / "tests" / "rust", ".rs") if m.rust else (ROOT / "tests" / "python", "")
        assert m.tests and all((folder / f"{t}{ending}").is_file() for t in m.tests), m.name
