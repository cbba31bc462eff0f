"""Named faults, each put into a copy of the tree, and the tests that have to fail there: python -m tests.mutants [NAME ...].

A mutant is one edit of one line. It is killed when one of its tests fails, and survives when they pass; tests that fail without any edit kill nothing,
so each set of tests runs once on the plain copy. ``--rust`` adds those of the core, each of which is compiled. The run fails if one survives.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
# Seconds in which the tests of a mutant end; one that never ends is noticed as well.
PATIENCE = 900
STATED = "test_stated_bounds.py"
CORE = "crates/interval-core/src"


@dataclass(frozen=True)
class Mutant:
    """A fault: ``old`` stands ``count`` times in ``file``, and becomes ``new``; ``tests`` are files of pytest, or of Cargo for the core."""

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]
    count: int = 1

    @property
    def rust(self) -> bool:
        """Whether it is one of the core."""
        return self.file.endswith(".rs")


def python(name: str, file: str, old: str, new: str, *tests: str, count: int = 1) -> Mutant:
    """A mutant of the package."""
    return Mutant(name, f"python/ivsid/{file}", old, new, tests or (STATED,), count)


def rust(name: str, file: str, old: str, new: str, *tests: str, count: int = 1) -> Mutant:
    """A mutant of the core."""
    return Mutant(name, f"{CORE}/{file}", old, new, tests, count)


MUTANTS = (
    # Sensors and the forces that no sensor sees.
    python("ambient at one sigma", "sensors/bounds.py", "k = rule.sigmas * (1 + ROUNDING)", "k = 1.0 * (1 + ROUNDING)"),
    python(
        "yaw ambient by the force",
        "rows/equations.py",
        'reach = moment if channel == "yaw" else force',
        "reach = force",
    ),
    python(
        "force ambient by the moment",
        "rows/equations.py",
        'reach = moment if channel == "yaw" else force',
        "reach = moment",
    ),
    python("no ambient in windows", "rows/integral.py", "+ equations.ambient(channel)", "+ 0.0"),
    python(
        "no ambient in pointwise rows",
        "rows/pointwise.py",
        "right = right + equations.ambient(channel)",
        "right = right + 0.0",
    ),
    python("window means of the ambient uncounted", "sensors/noise.py", "count += (1 + windows) * n", "count += n"),
    python("one-sided quantile", "sensors/noise.py", "(2 * max(errors, 1))", "(1 * max(errors, 1))"),
    python("no union bound", "sensors/noise.py", "(2 * max(errors, 1))", "2", "test_sensors.py"),
    python(
        "no bias", "sensors/noise.py", "k * walk / np.sqrt(dt) + k * bias", "k * walk / np.sqrt(dt)", "test_sensors.py"
    ),
    python("no hard bound", "sensors/noise.py", "noise + drift + sensor.accuracy", "noise + drift", "test_sensors.py"),
    python(
        "scale factor halved",
        "sensors/doppler.py",
        "0.0 if sign > 0 else -e,",
        "0.0 if sign > 0 else -e / 2,",
        "test_sensors.py",
    ),
    python(
        "accuracy of a velocity left out",
        "sensors/doppler.py",
        "(centre + IntervalArray(-accuracy, accuracy)) / scale",
        "centre / scale",
        "test_sensors.py",
    ),
    python(
        "average of a gyro a quarter",
        "sensors/bounds.py",
        "0.5 * limit * (before",
        "0.25 * limit * (before",
        "test_sampling.py",
        "test_stated_bounds.py",
    ),
    python(
        "accuracy of the heading halved",
        "sensors/bounds.py",
        "reach = np.nextafter(accuracy, np.inf)",
        "reach = 0.5 * accuracy",
    ),
    # Rows.
    python("windows across gaps ten times as long", "propulsion/lag.py", "GAP: Final = 1.5", "GAP: Final = 15.0"),
    python(
        "interpolation across gaps ten times as long",
        "log/record.py",
        "GAP: Final = 2.5",
        "GAP: Final = 25.0",
        "test_log_clocks.py",
    ),
    python("quadrature L h / 8", "rows/integral.py", "* self.steps * 0.25", "* self.steps * 0.125"),
    python(
        "ends of a step alone", "rows/integral.py", "x[:-1].hull(x[1:]) + self.steps * 0.5 * rate", "x[:-1].hull(x[1:])"
    ),
    python("reach within a step halved", "rows/integral.py", "+ self.steps * 0.5 * rate", "+ self.steps * 0.25 * rate"),
    python(
        "rate of a square without its factor",
        "rows/motion.py",
        "2.0 * abs(self.value) * self.rate)",
        "1.0 * abs(self.value) * self.rate)",
    ),
    python(
        "logged force of the row before",
        "rows/forces.py",
        "x[part].hull(x[part.start + 1 : part.stop + 1])\n    return ends",
        "x[part]\n    return ends",
        "test_rows.py",
    ),
    python(
        "sign of the known force",
        "rows/pointwise.py",
        "right = right + equations.ambient(channel)",
        "right = -right + equations.ambient(channel)",
        "test_rows.py",
    ),
    python(
        "curve of the heading halved", "sensors/weak_form.py", "longest**2 / 8", "longest**2 / 16", "test_weak_form.py"
    ),
    python(
        "bulge of the track a hundredth",
        "sensors/weak_form.py",
        "earth * longest**2 / 12",
        "earth * longest**2 / 1200",
        "test_weak_form.py",
    ),
    # Thrust.
    python(
        "accuracy of the middle of a range",
        "propulsion/thrust.py",
        "accuracy.relative * thrust.magnitude",
        "accuracy.relative * np.abs(thrust.midpoint)",
    ),
    python(
        "knots inside a range ignored",
        "propulsion/thrust.py",
        "holding = np.flatnonzero(first_knot < past)",
        "holding = np.zeros(0, dtype=int)",
    ),
    python(
        "absolute accuracy left out",
        "propulsion/thrust.py",
        "(accuracy.absolute + accuracy.relative",
        "(0.0 + accuracy.relative",
    ),
    python(
        "dead band always",
        "propulsion/thrust.py",
        "np.where(maybe_in, np.minimum(thrust.lower, 0.0), thrust.lower)",
        "thrust.lower",
    ),
    python(
        "reverse factor of all thrust",
        "propulsion/thrust.py",
        "_maximum(thrust, 0.0) + _minimum(thrust, 0.0) * factor",
        "thrust * factor",
        STATED,
        "test_thrust.py",
    ),
    python(
        "lag from rest",
        "propulsion/lag.py",
        "start = min(low, rest), max(high, rest)",
        "start = rest, rest",
    ),
    # Causes that [model.fitted] states.
    python(
        "sign of a fitted asymmetry",
        "propulsion/carried.py",
        "1.0 - of_decimals(ends_of(asymmetry))",
        "1.0 + of_decimals(ends_of(asymmetry))",
        "test_fitted_rows.py",
    ),
    python(
        "width of a fitted delay",
        "propulsion/carried.py",
        "slack = (half + 2 * reach) / step",
        "slack = 2 * reach / step",
        "test_late_demands.py",
    ),
    python(
        "sign of a fitted bias",
        "sensors/corrections.py",
        "x = x - of_decimals(found.bias[name])",
        "x = x + of_decimals(found.bias[name])",
        "test_fitted_rows.py",
    ),
    python(
        "a current that does not turn under the vessel",
        "sensors/corrections.py",
        '("udot", r * across), ("vdot", -(r * ahead))',
        '("udot", 0.0 * across), ("vdot", 0.0 * ahead)',
        "test_through_water.py",
    ),
    # Identification and validation.
    python(
        "ends that some vessel has",
        "identification/narrower.py",
        "bool((r < b.least).any())",
        "bool((r < b.least + 1e9).any())",
        "test_narrower.py",
    ),
    python("rows of a validation kept", "validation/checks.py", "    del rows\n", "", "test_long_logs.py"),
    python(
        "guaranteed under sigmas",
        "identification/method.py",
        "proved and bounded.rule.guaranteed and not",
        "proved and not",
        "test_sensors.py",
        "test_identification.py",
    ),
    python(
        "bounds printed inward",
        "files/records.py",
        "up=isinstance(value, Upper)",
        "up=not isinstance(value, Upper)",
        "test_identification.py",
    ),
    python(
        "claims at a bound contradicted",
        "identification/method.py",
        "not parameters[id_].lower <= value <= parameters[id_].upper",
        "not parameters[id_].lower < value - 1e9",
        "test_identification.py",
        "test_vehicle.py",
        "test_diagnosis_claims.py",
    ),
    python("contradictions uncounted", "validation/checks.py", "count - meets", "0", "test_validation.py"),
    python(
        "windows uncounted in a validation",
        "validation/checks.py",
        'bound_log(log, vehicle, window_count(fit.options["window"]))',
        "bound_log(log, vehicle)",
    ),
    # Verification.
    python(
        "the checker's constant halved",
        "verification/rows.py",
        "QUARTER: Final = Range(Fraction(1, 4))",
        "QUARTER: Final = Range(Fraction(1, 8))",
    ),
    python(
        "the checker's reach within a step",
        "verification/rows.py",
        "+ self.step_length(k) * HALF * sided(limits[n])",
        "+ self.step_length(k) * QUARTER * sided(limits[n])",
    ),
    python("the checker's gap", "verification/thrusters.py", "GAP: Final = 1.5", "GAP: Final = 15.0"),
    python(
        "the checker's yaw ambient",
        "verification/rows.py",
        'self.readings.ambient[channel == "yaw"]',
        "self.readings.ambient[0]",
    ),
    python(
        "the checker's ambient at one sigma",
        "verification/readings.py",
        "sided(self.factor * self.exact(ambient.force)), sided(self.factor * self.exact(ambient.moment))",
        "sided(self.exact(ambient.force)), sided(self.exact(ambient.moment))",
    ),
    python(
        "the checker's window means uncounted",
        "verification/readings.py",
        "count += (1 + self.windows) * n",
        "count += n",
    ),
    python(
        "the checker's knots",
        "verification/curves.py",
        "between = thrust[bisect_left(demand, low) : bisect_right(demand, high)]",
        "between = []",
    ),
    python(
        "the checker's accuracy of the least thrust",
        "verification/curves.py",
        "force.largest()",
        "Range(force.mignitude)",
    ),
    python(
        "more windows than were bounded",
        "verification/rows.py",
        "len(self._counts) > self.windows",
        "len(self._counts) > self.windows + 1",
    ),
    python(
        "a bound that is not proved",
        "verification/checker.py",
        "if direction * bound > proved[0]:",
        "if False:",
        "test_verification_edits.py",
    ),
    python(
        "columns that are not recomputed",
        "verification/checker.py",
        "_inside(matrix.get(id_, Range(0)), lower[k], upper[k]",
        "_inside(Range(lower[k]), lower[k], upper[k]",
        "test_verification_edits.py",
        "test_verification.py",
    ),
    python(
        "right-hand sides that are not recomputed",
        "verification/checker.py",
        "_inside(right_side, right[0], right[1]",
        "_inside(Range(right[0]), right[0], right[1]",
        "test_verification_edits.py",
        "test_verification.py",
    ),
    python(
        "negative multipliers",
        "verification/multipliers.py",
        "if any(m < 0 for m in multipliers):\n        return False",
        "if False:\n        return False",
        "test_multipliers.py",
    ),
    python(
        "seals unread",
        "verification/checker.py",
        "if not self.result.sealed:",
        "if False:",
        "test_verification.py",
        "test_verification_edits.py",
    ),
    # Diagnosis.
    python("level of the names 10 %", "diagnosis/null/levels.py", "NAMES: Final = 0.005", "NAMES: Final = 0.10"),
    python(
        "level of the structure 10 %", "diagnosis/null/levels.py", "STRUCTURE: Final = 0.0025", "STRUCTURE: Final = 0.1"
    ),
    python(
        "level of the calibration 10 %",
        "diagnosis/stages.py",
        "partial(calibrate, fit, seen, NAMES, seed)",
        "partial(calibrate, fit, seen, 0.10, seed)",
        "test_diagnosis.py",
    ),
    python(
        "null logs at ten times the level",
        "diagnosis/null/tail.py",
        "slope * np.log(share / self.level)",
        "slope * np.log(share / (10 * self.level))",
        "test_null_looks.py",
        "test_thresholds.py",
        STATED,
    ),
    python(
        "better than or equal to a limit",
        "diagnosis/null/rule.py",
        "(value >= limit) if self.least else (value <= limit)",
        "True",
        "test_rules.py",
    ),
    # Files.
    python(
        "files before the check of their places",
        "files/whole.py",
        "        for each in staging:\n            _check_places(each)\n",
        "",
        "test_faults_files.py",
    ),
    python("no way back", "files/whole.py", "_back(each.folder, each.place)", "pass", "test_faults_files.py"),
    python(
        "living runs cleared up",
        "files/owned.py",
        "        raise\n    except OSError:",
        "        pass\n    except OSError:",
        "test_faults_files.py",
    ),
    python(
        "abandoned changes dropped",
        "files/whole.py",
        "(_forward if state == COMMIT else _back)(folder, place)",
        "None",
        "test_faults_files.py",
    ),
    python(
        "parents unwatched", "intervals/apart.py", "and os.getppid() == parent", "and True", "test_faults_processes.py"
    ),
    # Rounding, and what stands on it, in the core.
    rust(
        "sums to nearest",
        "rounding/scalar.rs",
        "if small - (sum - large) > 0.0 { sum.above() } else { sum }",
        "sum",
        "rounding",
    ),
    rust(
        "sums that are exact widened",
        "rounding/scalar.rs",
        "if small - (sum - large) > 0.0 {",
        "if small - (sum - large) >= 0.0 {",
        "rounding",
    ),
    rust(
        "small products to nearest",
        "rounding/scalar.rs",
        "candidate < scaled || (candidate == scaled && x.mul_add(y, -scaled) > 0.0)",
        "false",
        "rounding",
    ),
    rust(
        "large products to nearest",
        "rounding/scalar.rs",
        "product_error(a, b, product) > 0.0",
        "product_error(a, b, product) > 1.0",
        "rounding",
    ),
    rust(
        "quotients to nearest",
        "rounding/scalar.rs",
        "if quotient.mul_add(denominator, -numerator) < 0.0 { quotient.above() } else { quotient }",
        "quotient",
        "rounding",
    ),
)


def copied(folder: Path) -> Path:
    """The files of the tree, with changes, and the compiled module."""
    listed = subprocess.run(
        ["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    for name in [*listed.stdout.splitlines(), *(str(p.relative_to(ROOT)) for p in ROOT.glob("python/ivsid/_core*.so"))]:
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, folder / name)
    return folder


def failed(tree: Path, mutant: Mutant) -> bool:
    """Whether one of the mutant's tests fails in a tree."""
    if mutant.rust:
        words = ["cargo", "test", "-q", "--profile", "gate", "--locked", "-p", "interval-core"]
        words += [w for t in mutant.tests for w in ("--test", t)]
        target = os.environ.get("CARGO_TARGET_DIR", str(ROOT / "target" / "mutants"))
        environment = {**os.environ, "CARGO_TARGET_DIR": target, "PROPTEST_RNG_SEED": "1"}
    else:
        there = [f"tests/python/{t}" for t in mutant.tests]
        words = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "-m", "not nightly", *there]
        paths = os.pathsep.join(str(tree / p) for p in ("python", "", "tests/python"))
        environment = {**os.environ, "PYTHONPATH": paths, "PYTHONDONTWRITEBYTECODE": "1"}
    try:
        done = subprocess.run(words, cwd=tree, env=environment, capture_output=True, timeout=PATIENCE, check=False)
    except subprocess.TimeoutExpired:
        return True
    if mutant.rust and b"could not compile" in done.stderr:
        raise SystemExit(f"{mutant.name} does not compile:\n{done.stderr.decode()[-2000:]}")
    if not mutant.rust and done.returncode not in (0, 1, 2):
        raise SystemExit(f"{mutant.name}: pytest ended with {done.returncode}\n{done.stdout.decode()[-2000:]}")
    return done.returncode != 0


def survives(tree: Path, mutant: Mutant) -> bool:
    """Whether the tests pass with the fault in the tree, which is left as it was."""
    path = tree / mutant.file
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != mutant.count:
        raise SystemExit(
            f"{mutant.name}: {mutant.file} has {text.count(mutant.old)} places of {mutant.old!r}, not {mutant.count}"
        )
    try:
        path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        return not failed(tree, mutant)
    finally:
        path.write_text(text, encoding="utf-8")


def main() -> int:
    """Runs the mutants that are named, or all."""
    words = [w for w in sys.argv[1:] if w != "--rust"]
    known = {m.name: m for m in MUTANTS}
    if wrong := set(words) - known.keys():
        sys.stderr.write(f"no mutant {', '.join(sorted(wrong))}; there are {', '.join(known)}\n")
        return 2
    chosen = [known[w] for w in words] or [m for m in MUTANTS if not m.rust or "--rust" in sys.argv]
    alive = []
    with tempfile.TemporaryDirectory() as folder:
        tree = copied(Path(folder))
        sound: set[tuple[str, ...]] = set()
        for mutant in chosen:
            if mutant.tests not in sound and failed(tree, mutant):
                sys.stderr.write(f"{', '.join(mutant.tests)} fails without a fault\n")
                return 2
            sound.add(mutant.tests)
            begin = time.monotonic()
            left = survives(tree, mutant)
            alive += [mutant.name] * left
            sys.stdout.write(f"{'SURVIVES' if left else 'killed'}: {mutant.name} ({time.monotonic() - begin:.0f} s)\n")
            sys.stdout.flush()
    sys.stdout.write(f"test result: {len(chosen) - len(alive)} passed, {len(alive)} failed\n")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
