"""Files that want a fault or a terminal that obeys them: nested deeply, or with control characters in names."""

import json

import pytest

from command_line import run
from ivsid import IvsidError, read_log
from ivsid.errors import ANY_CONTROL
from ivsid.programme.scenario import parse_scenario
from ivsid.vehicle import parse_vehicle

BOAT = 'name = "b"\n[hull]\nmass = 10.0\nlength = 1.0\n'
DEEP = [
    "a = " + "[" * 100_000 + "]" * 100_000,
    "[" + ".".join(["a"] * 3000) + "]",
    "a = " + "{a=" * 150 + "1" + "}" * 150,
]


@pytest.mark.parametrize("text", DEEP)
@pytest.mark.parametrize("parse", [parse_vehicle, parse_scenario])
def test_tables_in_tables_get_a_sentence(text, parse):
    with pytest.raises(IvsidError, match="more than 100 deep"):
        parse(text, "deep.toml")


@pytest.mark.parametrize("command", [["validate"], ["verify"], ["export", "--to", "mss"]])
def test_a_deep_result_gets_a_sentence(command, tmp_path):
    for name, text in (("lists", "[" * 200_000 + "]" * 200_000), ("tables", '{"a":' * 500 + "1" + "}" * 500)):
        file = tmp_path / name / "result.json"
        file.parent.mkdir(exist_ok=True)
        file.write_text(text)
        log = [tmp_path / "log.csv"] if command == ["validate"] else []
        done = run(*command, file.parent, *log, "--out", tmp_path / "out")
        assert done.returncode == 2 and done.stderr.startswith("ivsid: "), done.stderr
        assert len(done.stderr.splitlines()) == 1 and "fault" not in done.stderr


@pytest.mark.parametrize("bad", ["\\u001b[31m", "\\u0007", "\\u009b2J", "\\u007f"])
def test_a_name_that_commands_the_terminal_is_refused(bad):
    with pytest.raises(IvsidError, match="control character U\\+00"):
        parse_vehicle(BOAT.replace('"b"', f'"b{bad}"'), "boat.toml")
    with pytest.raises(IvsidError, match="control character"):
        parse_vehicle(BOAT + f'[log]\n"u{bad}" = "speed"\n', "boat.toml")


def test_a_file_name_reaches_the_terminal_as_text(tmp_path):
    vehicle = tmp_path / "boat.toml"
    vehicle.write_text(BOAT)
    for name in ("evil\x1b[31m.csv", "bell\x07.csv", "csi\x9b2J.csv"):
        # Missing, unreadable as a table, and without the columns: each sentence names the file.
        for content in (None, b"\xff\x00", b"t,u\n0,1\n1,2\n"):
            log = tmp_path / name
            if content is not None:
                log.write_bytes(content)
            done = run("identify", vehicle, log, "--out", tmp_path / "out")
            assert done.returncode == 2
            assert not any(c in done.stderr for c in "\x1b\x07\x9b"), repr(done.stderr)
            assert "\\x" in done.stderr


def test_json_on_the_terminal_is_json(tmp_path):
    done = run("example", tmp_path / "ex", "--json")
    assert done.returncode == 0 and isinstance(json.loads(done.stdout), dict)


def test_a_sentence_stays_on_its_line(tmp_path):
    """Cells and names with line breaks and control characters stand in the sentence as escapes, in Python as well."""
    log = tmp_path / "run.csv"
    for cell, shown in (('"9\n3"', r"9\n3"), ("9\u20283", r"9\u20283")):
        log.write_text("t,u,v,r\n0,1,1,1\n1,1,1,1\n2," + cell + ",1,1\n")
        with pytest.raises(IvsidError) as refusal:
            read_log(log)
        assert shown in str(refusal.value) and not ANY_CONTROL.search(str(refusal.value))
    assert str(IvsidError("a\x7fb\x1b\r\nc\td")) == r"a\x7fb\x1b\r\nc\td"
