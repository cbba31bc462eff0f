"""Faults in all that makes a result: sensors, rows, thrust, identification and validation."""

from tests.mutant import STATED, python

RESULTS = (
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
)
