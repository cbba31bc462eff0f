"""Faults in verification, files and processes, and in the rounding of the core."""

from tests.mutant import python, rust

PROOFS = (
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
        "test_faults_kills.py",
    ),
    python(
        "abandoned changes dropped",
        "files/whole.py",
        "(_forward if state == COMMIT else _back)(folder, place)",
        "None",
        "test_faults_kills.py",
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
