"""Every rule of the diagnosis stands on the page docs/rules.md, and is counted by benches/rules.py."""

import importlib
import importlib.util
import pkgutil
from pathlib import Path

import pytest

import ivsid.diagnosis
from ivsid.diagnosis.null import rule

ROOT = Path(__file__).resolve().parents[2]


def loaded(path):
    spec = importlib.util.spec_from_file_location(f"loaded_{path.parent.name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def modules():
    walked = pkgutil.walk_packages(ivsid.diagnosis.__path__, "ivsid.diagnosis.")
    return [importlib.import_module(m.name) for m in walked]


def rules_in(modules):
    """Rules by name, from all values of the modules and from their tuples."""
    values = [v for m in modules for v in vars(m).values()]
    inside = [w for v in values if isinstance(v, tuple) for w in v]
    return {r.name for r in (*values, *inside) if isinstance(r, rule.Rule)}


def test_the_page_and_the_count_have_every_rule(modules):
    names = rules_in(modules)
    page, bench = loaded(ROOT / "docs" / "rules.py"), loaded(ROOT / "benches" / "rules.py")
    assert len(names) > 20
    assert {r.name for rules in page.STAGES.values() for r in rules} == names
    assert {r.name for r in bench.ALL} == names
    assert page.page() == page.PAGE.read_text()


def test_the_count_asks_wherever_rules_are_asked_in_turn(modules):
    """It puts itself in the place of ``first_refusal`` of each module that asks."""
    asking = {m.__name__.rpartition(".")[2] for m in modules if "first_refusal" in vars(m)} - {"rule"}
    text = (ROOT / "benches" / "rules.py").read_text()
    (line,) = [q for q in text.splitlines() if q.strip().startswith("for module in (")]
    assert {q.strip() for q in line[line.index("(") + 1 : line.index(")")].split(",")} == asking
