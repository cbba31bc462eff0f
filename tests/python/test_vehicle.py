"""Vehicle files: what is accepted, and one sentence for each fault."""

import pytest

from ivsid import IvsidError
from ivsid.vehicle import parse_vehicle, read_vehicle

HEAD = 'name = "a"\n[hull]\nmass = 3\n'
TABLE = '[[thrusters]]\nname = "p"\n[thrusters.table]\ndemand = [1, 2]\n'


def test_the_paper_s_vehicle(swan):
    assert swan.name == "SWAN" and swan.hull.mass == 52.45
    assert [t.name for t in swan.thrusters] == ["port", "starboard"]
    assert swan.model.terms == "paper"
    assert len(swan.sha256) == 64


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        (HEAD + "mas = 3\n", ["hull.mas", "did you mean mass?", "allowed here"]),
        ('name = "a"\n[hul]\nmass = 3\n', ["key hul is unknown", "did you mean hull?"]),
        (HEAD + "[sensors.velocity]\nacuracy = 1\n", ["sensors.velocity.acuracy", "did you mean accuracy?"]),
        (HEAD + "[sensors]\nsigmas = 3\nconfidence = 0.9\n", ["both confidence and sigmas"]),
        (HEAD + "[sensors]\nconfidence = 1.5\n", ["sensors.confidence", "1.5", "less than 1"]),
        ('name = "a"\n[hull]\nmass = -3\n', ["hull.mass = -3", "greater than 0"]),
        ('name = "a"\n[hull]\nmass = "x"\n', ["hull.mass", "'x'", "number"]),
        ('name = "a"\n', ["key hull is missing"]),
        (HEAD + TABLE + "thrust = [1, 2, 3]\n", ["2 demands but 3 thrusts"]),
        (HEAD + TABLE + 'thrust = [1, 2]\nunit = "stone"\n', ["stone", "use one of N, kN, kgf"]),
        (HEAD + TABLE.replace("[1, 2]", "[2, 1]") + "thrust = [1, 2]\n", ["increase strictly"]),
        (HEAD + '[[thrusters]]\nname = "p"\n', ["no thrust curve", "table, polynomial, gain"]),
        (HEAD + '[[thrusters]]\nname = "p"\ngain = 1\n[[thrusters]]\nname = "p"\ngain = 1\n', ["repeat"]),
        (HEAD + '[model]\nterms = "papre"\n', ["model.terms = 'papre'", "list of ids"]),
        (HEAD + '[log]\ntime = { from = "x", unit = "fortnight" }\n', ["fortnight", "use one of s, ms"]),
        (HEAD + '[log.columns]\nu = { from = "x", unit = "furlong" }\n', ["furlong", "use one of"]),
        (HEAD + "name = 3\n[[", ["not valid TOML"]),
        ("", ["is empty"]),
    ],
)
def test_one_sentence_names_file_key_and_remedy(text, parts):
    with pytest.raises(IvsidError) as caught:
        parse_vehicle(text, "boat.toml")
    sentence = str(caught.value)
    assert "boat.toml" in sentence and "\n" not in sentence
    for part in parts:
        assert part in sentence


def test_files_that_cannot_be_read(tmp_path):
    with pytest.raises(IvsidError, match="cannot be read"):
        read_vehicle(tmp_path / "none.toml")
    binary = tmp_path / "b.toml"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(IvsidError, match="not a text file"):
        read_vehicle(binary)


@pytest.mark.parametrize("name", ["otter", "otter_extended"])
def test_example_vehicles_are_valid(name):
    from pathlib import Path

    assert read_vehicle(Path(__file__).parents[2] / "examples" / f"{name}.toml").thrusters
