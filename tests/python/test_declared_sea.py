"""An ambient force of any spectrum inside [ambient] is declared, a single line as well; what repeats within a turn is not."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from tests.exam.cases import case, setting

from diagnosis_logs import logs_of_case, train_of, vehicle_of
from ivsid import diagnose
from ivsid.diagnosis.candidates.families import everything
from ivsid.diagnosis.data.channels import channels
from ivsid.diagnosis.estimation.learning import plain_fit
from ivsid.diagnosis.estimation.projection import least_length
from ivsid.diagnosis.null.screening import DECLARED_SEA, Case
from ivsid.diagnosis.selection.adequacy import adequacy
from ivsid.diagnosis.selection.dictionary import in_words
from ivsid.diagnosis.selection.rivals import possible
from ivsid.effects import EFFECTS, Given
from ivsid.log import Log
from ivsid.vehicle import parse_vehicle

VESSEL = {"kind": "vectored", "style": "rich", "ambient": 1.0, "duration": 300.0, "rate": 10.0, "share": 0.5}
FORCE = 10.0


def drawn(seed, hidden=None, **more):
    here = setting(seed, **VESSEL, **more)
    truth = {} if hidden is None else here.draw(*hidden)
    logs = [Log(f"{k}.csv", "0" * 64, q.pop("t"), q) for k, q in enumerate(here.logs(truth), 1)]
    return parse_vehicle(here.text, "vehicle.toml"), *logs


def diagnosed(seed, hidden=None, **more):
    return diagnose(*drawn(seed, hidden, **more))


def swell(amplitude, shown, force=FORCE):
    """A swell of 5 s with this fall of chi-squared, where this ambient force is declared."""
    effect = EFFECTS["wave.force"]
    ambient = None if force is None else SimpleNamespace(force=force)
    predictor = SimpleNamespace(vehicle=SimpleNamespace(ambient=ambient))
    numbers = {"amplitude": amplitude, "period": 5.0, "phase": 0.3, "direction": 0.7}
    s = SimpleNamespace(
        candidate=SimpleNamespace(effect=effect, given=lambda x: Given(effect, x)),
        values=tuple(numbers[p.part] for p in effect.parameters),
        shown=shown,
        columns=(0,),
    )
    return Case(SimpleNamespace(fit=SimpleNamespace(noise=SimpleNamespace(predictor=predictor))), s)


def test_a_swell_counts_from_the_rms_of_the_declared_force_on():
    """A sine along one direction has the rms of 10 N ahead and 10 N sideways at an amplitude of 20 N."""
    rms = math.hypot(FORCE, FORCE)
    known = 1e8
    assert DECLARED_SEA.refuses(swell(0.999 * rms * math.sqrt(2), known)) is not None
    assert DECLARED_SEA.refuses(swell(1.001 * rms * math.sqrt(2), known)) is None
    # With a tenth of its size as standard error it has to lie three of them above.
    assert DECLARED_SEA.refuses(swell(1.4 * rms * math.sqrt(2), 100.0)) is not None
    assert DECLARED_SEA.refuses(swell(1.45 * rms * math.sqrt(2), 100.0)) is None
    assert DECLARED_SEA.refuses(swell(1e-3, 30.0, force=None)) is None


def test_the_least_size_of_a_force_is_that_of_what_the_log_knows():
    """Ahead a log knows 3 N to 0.1 N, sideways nothing of -8 N; where it knows all directions alike, three errors of the length are less."""
    theta = np.array([3.0, -8.0])
    blind = least_length(theta, np.diag([100.0, 1e-6]), 3.0)
    assert blind == pytest.approx((3.0 - 0.3) / math.hypot(*theta), rel=1e-3)
    same = least_length(theta, 4.0 * np.eye(2), 3.0)
    assert same == pytest.approx(1.0 - 3.0 / (2.0 * math.hypot(*theta)))
    # By vertices of the ellipse, as finely as they are drawn.
    turned = np.array([[5.0, 2.0], [2.0, 1.5]])
    around = np.linspace(0.0, 2.0 * np.pi, 20001)
    circle = 3.0 * np.linalg.solve(np.linalg.cholesky(turned).T, np.stack([np.cos(around), np.sin(around)]))
    nearest = np.linalg.norm(theta[:, None] + circle, axis=0).min()
    assert least_length(theta, turned, 3.0) * math.hypot(*theta) == pytest.approx(nearest, rel=1e-6)


def test_a_square_wave_inside_the_declared_force_is_no_swell_on_a_line():
    """Its size sideways is mostly error: the swell was 1.4 N rms, of which 0.3 N ahead, and 0.36 N are declared."""
    c = case(271059, what="none", sea="any", sensors="any")
    found = diagnose(parse_vehicle(c.text, "v.toml"), *logs_of_case(c), null_logs=0)
    assert found.verdict == "adequate" and not found.findings


@pytest.mark.parametrize(("amplitude", "can"), [(19.0, False), (21.0, True)])
def test_a_swell_inside_the_declared_force_stands_in_no_set(amplitude, can):
    """A weak pod of a catamaran was taken for a swell of a tenth of the declared force."""
    effect = EFFECTS["wave.force"]
    numbers = {"amplitude": amplitude, "period": 5.0, "phase": 0.3, "direction": 0.7}
    given = Given(effect, tuple(numbers[p.part] for p in effect.parameters))
    predictor = SimpleNamespace(
        vehicle=SimpleNamespace(ambient=SimpleNamespace(force=FORCE)),
        log=SimpleNamespace(n=1000, h=0.1, nu=[[1.0, -1.0]]),
    )
    assert possible(SimpleNamespace(terms=(), given=(given,), freed=()), effect.id, predictor) == can


def test_the_force_of_an_effect_is_that_of_its_definition():
    """A swell of 3 N has an rms of 3 N over the root of two, whatever the hull, and a tide one in proportion to its speed."""
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=150.0), vehicle), everything)
    swell = {"amplitude": 3.0, "period": 5.0, "phase": 0.3, "direction": 0.7}
    tide = {"north": 0.04, "east": -0.03, "period": 40.0, "phase": 1.0}

    def push(id_, numbers):
        effect = EFFECTS[id_]
        return fit.signatures.push(Given(effect, tuple(numbers[p.part] for p in effect.parameters)))

    assert push("wave.force", swell) == pytest.approx(3.0 / math.sqrt(2.0), rel=0.01)
    slow, fast = (push("current.oscillating", tide | {"north": k * 0.04, "east": -k * 0.03}) for k in (0.1, 0.2))
    assert fast == pytest.approx(2.0 * slow, rel=0.05)
    # Inertia alone at the least: the hull's own mass has no part in it, and the added mass in sway is 25 kg of 50.
    assert slow > 0.005 * (2 * math.pi / 40.0) / math.sqrt(2.0) * 8.0


@pytest.mark.parametrize(("metres", "refused"), [(0.001, True), (0.3, False)])
def test_a_tide_that_pushes_less_than_the_declared_force_is_a_part_of_it(metres, refused):
    """A narrow swell over ground was a current of 34 s of 0.02 m/s, at a fifth of the declared force of a ferry."""
    vehicle = vehicle_of()
    fit = plain_fit(vehicle, channels(train_of(vehicle, duration=150.0), vehicle), everything)
    effect = EFFECTS["current.oscillating"]
    numbers = {"north": metres, "east": 0.0, "period": 30.0, "phase": 0.0}
    s = SimpleNamespace(
        candidate=SimpleNamespace(effect=effect, given=lambda x: Given(effect, x)),
        values=tuple(numbers[p.part] for p in effect.parameters),
        shown=1e6,
        columns=(0,),
    )
    assert (DECLARED_SEA.refuses(Case(SimpleNamespace(fit=fit), s)) is not None) is refused


# Nightly: more draws of the same sea.
@pytest.mark.parametrize(
    "seed", [43, *[pytest.param(k, marks=pytest.mark.nightly) for k in (48, *range(182100, 182112))]]
)
def test_a_sea_of_a_few_lines_makes_no_finding(seed):
    result = diagnosed(seed, sea="lines")
    assert (result.verdict, result.findings) == ("adequate", ())


HARMONICS = (("x.windage", "sin 2 psi in yaw"), ("x.house", "cos 3 psi in surge"))


@pytest.mark.parametrize(("hidden", "function"), HARMONICS[:1])
def test_a_force_that_repeats_within_a_turn_is_structure(hidden, function):
    vehicle, train, _ = drawn(40, (hidden, 1.0))
    left = adequacy(plain_fit(vehicle, channels(train, vehicle), everything))
    assert not left.white and function in {in_words(f"{channel}|{name}") for name, channel, _ in left.strongest}


# Nightly: whole diagnoses; the gate has the structure of one of both logs above.
@pytest.mark.nightly
@pytest.mark.parametrize(("hidden", "function"), HARMONICS)
def test_a_force_that_repeats_within_a_turn_is_unknown(hidden, function):
    """Forces of four and of nine times the declared ambient force were adequate: the dictionary had no harmonics of the heading."""
    result = diagnosed(40, (hidden, 1.0))
    (finding,) = result.findings
    assert result.verdict == finding.effect == "unknown" and function in finding.description
