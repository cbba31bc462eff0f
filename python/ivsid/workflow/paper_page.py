"""The page of ``ivsid demo``: figures, tables and words beside the numbers that the paper prints."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ivsid.identification import Identification
from ivsid.identification.constriction import Constriction
from ivsid.intervals import EndpointPair, Interval, IntervalArray, shown
from ivsid.linear import linalg
from ivsid.log import Log
from ivsid.propulsion import bollard
from ivsid.report import figures, page
from ivsid.report.figures import Drawing
from ivsid.report.page import Cells, Part, Section
from ivsid.sensors.allan import AllanDeviation
from ivsid.sensors.doppler import doppler_drift, doppler_paper
from ivsid.sensors.noise import sigma_published
from ivsid.simulation import Simulated
from ivsid.validation import Validation
from ivsid.vehicle import Vehicle
from ivsid.workflow.allan_analysis import coefficient_rows, coefficient_table
from ivsid.workflow.log_files import log_series
from ivsid.workflow.parameters import method_table, parameter_bars, parameter_lines, status_line
from ivsid.workflow.thrust_curves import fit_table
from ivsid.workflow.validation import (
    motion_table,
    validation_drawings,
    validation_lines,
    validation_summary,
    validation_table,
)

# Parameter intervals as printed.
# Source: paper: Table V
TABLE_V = {
    "added mass [kg]": (-31.8686, 8.1316),
    "drag [kg/m]": (235.7778, 275.7781),
    "moment of inertia [kg m²]": (-41.7606, 48.2396),
}
# Mean and standard deviation of the validation errors as printed [N, N m].
# Source: paper: printed validation errors
PRINTED_ERRORS = {"surge": (1.955, 2.699), "yaw": (0.963, 0.785)}


@dataclass(frozen=True)
class Trial:
    """A simulated trial and the files that hold it."""

    made: Simulated
    log: Log
    text: str


def paper_numbers() -> dict[str, Any]:
    """Numbers printed in the paper that can be computed again (docs/theory.md, "The paper's equations, as corrected")."""
    q = IntervalArray(np.array([[2, -2], [-1.5, -2]]), np.array([[4, 2], [4.5, 3.5]]))
    one = IntervalArray([[1.0]], [[2.0]])
    literal = linalg.inverse_one(one, "published", 10)
    exact = linalg.inverse_one(one, "exact")
    u = doppler_paper(np.array([2.0]), 0.002, 0.004)
    return {
        "norm": linalg.norm(q),
        "midpoint": q.midpoint,
        "radius": q.radius,
        "doppler_drift_per_hour": doppler_drift(0.004, 2.0, 3600.0),
        "inverse_of_1_2": {"exact": _pair(exact.value), "published_10": _pair(literal.value)},
        "sigma_c": {
            "x": sigma_published(0.0018, 3.0e-4, 0.05, 670.0),
            "y": sigma_published(0.002, 2.8e-4, 0.05, 100.0),
        },
        "velocity_2": [float(u.lower[0]), float(u.upper[0])],
    }


def _pair(value: object) -> list[float]:
    assert isinstance(value, (IntervalArray, EndpointPair))
    return [float(value.lower.ravel()[0]), float(value.upper.ravel()[0])]


def drawings_of(
    log: Log,
    curves: dict[str, AllanDeviation],
    table: bollard.Bollard,
    fits: list[Identification],
    checks: list[Validation],
) -> tuple[Drawing, ...]:
    """Figs 1 to 7, the trial, and the parameters by method."""
    accelerations = {k: v for k, v in curves.items() if k != "r"}
    first = (
        figures.allan_curves(
            accelerations, "fig1_allan_acceleration", "Fig. 1: Allan deviation of the accelerations (twin)", "m/s²"
        ),
        figures.allan_curves(
            {"r": curves["r"]}, "fig2_allan_yaw_rate", "Fig. 2: Allan deviation of the yaw rate (twin)", "rad/s"
        ),
        figures.thrust_curve(table, "fig3_thrust", "Fig. 3: thrust against demand, Table III"),
        figures.channels(log, "train"),
        figures.intervals(fits),
    )
    return (*first, *validation_drawings(checks[0], "fig4-7_"), *validation_drawings(checks[1], "constricted_"))


def sections_of(
    vehicle: Vehicle,
    train: Trial,
    curves: dict[str, AllanDeviation],
    table: bollard.Bollard,
    fits: list[Identification],
    inverses: dict[str, Any],
    published: Identification,
    narrowed: Constriction,
    checks: list[Validation],
    drawings: tuple[Drawing, ...],
) -> tuple[Section, ...]:
    """The sections of the page, in the order of the paper."""
    shown_figures = {d.name: page.drawing(d) for d in drawings}
    validated = [p for name, p in shown_figures.items() if name.startswith("fig4-7_")]
    heuristic = [p for name, p in shown_figures.items() if name.startswith("constricted_")]
    rows = coefficient_rows(
        curves, {n: float("nan") for n in curves}, {n: "rad/s" if n == "r" else "m/s^2" for n in curves}
    )
    return (
        Section("The twin", (page.bullets(_twin(vehicle, train)), log_series(train.log), _table_iv(vehicle))),
        Section(
            "Sensors (Table II, eq. 15, Figs 1-2)",
            (
                coefficient_table([[*r[:-1], None] for r in rows]),
                shown_figures["fig1_allan_acceleration"],
                shown_figures["fig2_allan_yaw_rate"],
            ),
        ),
        Section(
            "Thrust (Table III, eq. 18, Fig. 3)",
            (page.text(_thrust_words(table)), fit_table(table), shown_figures["fig3_thrust"]),
        ),
        Section(
            "Parameters by every method",
            (parameter_bars(fits), method_table(fits), page.bullets(fits[0].assumes)),
        ),
        Section("The published inverse beside the exact one", _inverse_parts(inverses)),
        Section("Table V", _table_v(fits[0], published, narrowed, vehicle)),
        Section(
            "Validation on the second trial, feasible parameters (Figs 4-7)",
            (validation_table(checks[0]), *validated, motion_table(checks[0])),
        ),
        Section(
            "Validation of the constricted intervals",
            (
                page.text("The heuristic's intervals claim nothing; this is what they do on the second trial."),
                validation_table(checks[1]),
                *heuristic,
                _errors(checks),
            ),
        ),
        Section("Numbers of the paper, computed again", (_reproduced(),)),
    )


def _twin(vehicle: Vehicle, train: Trial) -> list[str]:
    truth = ", ".join(f"{k} = {v:g}" for k, v in train.made.truth["parameters"].items())
    thrusters = "; ".join(f"{t.name} at ({t.position[0]:g}, {t.position[1]:g}) m" for t in vehicle.thrusters)
    return [
        "The paper's trials are not public: both trials are simulated with its mass, thrust table and sensors.",
        f"Truth (chosen): {truth}; hidden from every step below.",
        f"Thrusters (assumed, the paper prints no arms): {thrusters}.",
        "Both trials, their truth and the vehicle file stand beside this page: train.csv, test.csv, truth.json, swan.toml.",
    ]


def _table_iv(vehicle: Vehicle) -> Part:
    x, y = vehicle.hull.centre_of_gravity
    rows = [["centre of gravity x_G [mm]", -1.06, 1e3 * x], ["centre of gravity y_G [mm]", -2.95, 1e3 * y]]
    return page.table(["Table IV", "paper", "twin"], rows)


def _thrust_words(table: bollard.Bollard) -> str:
    at = dict(zip(table.demand, table.fits[0].residual, strict=True))
    return (
        f"The printed coefficients of eq. 18 miss Table III by {at[15.0]:+.1f} N at 15 %, {at[50.0]:+.1f} N at 50 % and "
        f"{at[85.0]:+.1f} N at 85 %. The table is followed instead."
    )


def _inverse_parts(inverses: dict[str, Any]) -> tuple[Part, ...]:
    """The published inverses beside the exact hull."""
    rows: list[Cells] = []
    entries = inverses["entries"]
    for method in ("published", "published-hull"):
        if method in inverses:
            found = inverses[method]
            rows.append(
                [method, f"{found['improper']} of {entries}", f"{found.get('enclosed_entries', '–')} of {entries}"]
            )
    first = page.table(
        ["inverse of A'A (mass, drag)", "improper entries", "entries that enclose the exact hull's"],
        rows,
        f"N = {inverses['partitions']} partitions",
    )
    widths = [[m, i, float(r)] for m, ratios in inverses["width_over_feasible"].items() for i, r in ratios.items()]
    second = page.table(["method (eq. 14)", "parameter", "width over the feasible set's"], widths)
    values = []
    for i, j in np.ndindex(*np.shape(inverses["published"]["lower"])):
        cells: list[object] = [f"({i + 1}, {j + 1})"]
        for method in ("published", "published-hull", "exact"):
            cells.append(
                f"[{inverses[method]['lower'][i, j]:.6g}, {inverses[method]['upper'][i, j]:.6g}]"
                if method in inverses
                else "–"
            )
        values.append(cells)
    third = page.table(["entry of (A'A)⁻¹", "eq. 11 literally", "hull over both sets", "exact hull"], values)
    words = page.text(
        "Eq. 11 follows one diagonal of the box of matrices. Its result is kept as it comes out, improper entries included, and is never "
        "called guaranteed; through eq. 14 it is also far wider than the set of parameters that the samples allow."
    )
    return words, first, third, second


def _table_v(
    feasible: Identification, published: Identification, narrowed: Constriction, vehicle: Vehicle
) -> tuple[Part, ...]:
    ids = ("mass.surge", "drag.surge.quadratic", "inertia.yaw")
    rows = []
    for (label, printed), id_, added_id in zip(TABLE_V.items(), ids, published.parameters, strict=True):
        p = feasible.parameters.get(id_)
        ours = "–"
        if p is not None:
            box = Interval(p.lower, p.upper)
            value = box - vehicle.hull.mass if id_ == "mass.surge" else box
            ours = shown(value.lower, value.upper)
        k = list(published.parameters).index(added_id)
        wide = published.parameters[added_id]
        rows.append(
            [
                label,
                f"[{printed[0]:g}, {printed[1]:g}]",
                f"[{wide.lower:.6g}, {wide.upper:.6g}]",
                f"[{narrowed.lower[k]:.6g}, {narrowed.upper[k]:.6g}]",
                ours,
            ]
        )
    header = [
        "parameter",
        "paper, Table V",
        "eq. 11 and 14 on the twin (not guaranteed)",
        "the same, constricted (not guaranteed)",
        "feasible (guaranteed)",
    ]
    words = page.text(
        "Added mass with the rigid-body mass known (second form of eq. 6). The paper's widths of 40, 40 and 90 are the mark of its heuristic "
        f"constriction; ours accepted {narrowed.steps} halvings and kept {100 * narrowed.coverage:.1f} % of the measured forces inside."
    )
    return words, page.table(header, rows)


def _errors(checks: list[Validation]) -> Part:
    rows = []
    for check in checks:
        for f in check.forces:
            printed = PRINTED_ERRORS.get(f.channel)
            rows.append([check.fit.method, f.channel, f.mean_absolute, f.mean, f.sigma, *(printed or (None, None))])
    return page.table(
        ["method", "channel", "mean |error|", "mean error", "sigma", "paper mean", "paper sigma"],
        rows,
        "Errors beside the paper's printed ones",
    )


def _reproduced() -> Part:
    n = paper_numbers()
    low, high = n["inverse_of_1_2"]["published_10"]
    exact = n["inverse_of_1_2"]["exact"]
    rows: list[Cells] = [
        ["norm of Q (IV.A)", "8", float(n["norm"])],
        ["radius of Q at (2,2) (IV.A)", "2.25 (misprint)", float(n["radius"][1, 1])],
        ["Doppler drift in an hour at 2 m/s", "28.8 m", float(n["doppler_drift_per_hour"])],
        ["inverse of [1, 2], exact", "–", f"[{exact[0]:g}, {exact[1]:g}]"],
        ["inverse of [1, 2], eq. 11 with N = 10", "–", f"[{low:.6g}, {high:.6g}], improper"],
        ["sigma_c of ax at 0.05 s (eq. 15)", "–", float(n["sigma_c"]["x"])],
        ["sigma_c of ay at 0.05 s (eq. 15)", "–", float(n["sigma_c"]["y"])],
        [
            "velocity of a reading of 2 m/s (eq. 16, corrected)",
            "–",
            f"[{n['velocity_2'][0]:.6g}, {n['velocity_2'][1]:.6g}]",
        ],
    ]
    return page.table(["number", "printed", "computed"], rows)


def lines_of(fits: list[Identification], inverses: dict[str, Any], checks: list[Validation]) -> tuple[str, ...]:
    """The result of the demo, for the terminal."""
    feasible = fits[0]
    word = "guaranteed" if feasible.guaranteed else "not guaranteed"
    ids = ", ".join(f"{i} {shown(p.lower, p.upper, 4)} {p.unit}" for i, p in feasible.parameters.items())
    lines = [f"Feasible set ({feasible.status}, {word}): {ids or 'no parameter'}."]
    for fit in fits:
        lines += [status_line(fit), *parameter_lines(fit)]
    for method in ("published", "published-hull"):
        if method in inverses:
            found = inverses[method]
            lines.append(
                f"{method} inverse: {found['improper']} of {inverses['entries']} entries improper, {found.get('enclosed_entries', 0)} enclose the exact hull's"
            )
    lines += [validation_summary(checks[0]), *validation_lines(checks[0])]
    return tuple(lines)
