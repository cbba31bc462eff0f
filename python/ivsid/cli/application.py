"""``ivsid``: one function a command."""

from __future__ import annotations

import math
import sys
import warnings
from collections.abc import Callable, Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.console import Console

from ivsid.errors import IvsidError

app = typer.Typer(
    name="ivsid",
    help="Guaranteed system identification for unmanned marine vehicles.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

Out = Annotated[
    Path | None,
    typer.Option("--out", help="Folder for result.json, figures and report.html.", show_default="ivsid-COMMAND"),
]
Json = Annotated[bool, typer.Option("--json", help="Print only the JSON of result.json.")]
Seed = Annotated[int | None, typer.Option("--seed", min=0, help="Seed of the random numbers.")]


def _version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"ivsid {version('ivsid')}")
        raise typer.Exit


@app.callback()
def _root(
    _version_wanted: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
    own: Annotated[
        list[Path] | None,
        typer.Option(
            "--own-effects",
            metavar="FILE",
            help="Python file with effects of your own, for every command; it is run. Stands before the command; may repeat.",
        ),
    ] = None,
) -> None:
    """Options of every command."""
    if own:
        from ivsid.effects import read_effects  # noqa: PLC0415 - as the commands' own imports

        for path in own:
            read_effects(path)


@app.command()
def demo(out: Out = None, json: Json = False, seed: Seed = None) -> None:
    """The paper's experiment end to end on a twin of its vehicle."""
    _run("demo", out, json, lambda w, p: w.demo(seed=seed, progress=p))


@app.command()
def simulate(
    vehicle: Annotated[Path, typer.Argument(help="Vehicle file (TOML), or otter or vectored_rov.")],
    scenario: Annotated[Path, typer.Argument(help="Scenario file (TOML), or otter or vectored_rov.")],
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
    effect: Annotated[
        list[str] | None,
        typer.Option("--effect", help="An effect of the catalogue with its numbers, ID=VALUE or ID=A,B; may repeat."),
    ] = None,
    hide: Annotated[
        int | None, typer.Option("--hide", min=0, help="Draw a hidden effect from this seed; only truth.json names it.")
    ] = None,
    effects: Annotated[
        int | None, typer.Option("--effects", min=1, max=5, help="Hide exactly so many effects at once, with --hide.")
    ] = None,
    table: Annotated[str, typer.Option("--format", help="Format of the log: csv or parquet.")] = "csv",
    truth: Annotated[
        Path | None,
        typer.Option(
            "--truth", help="Where the truth goes; with --hide OUT-truth/truth.json by default, else OUT/truth.json."
        ),
    ] = None,
) -> None:
    """A log with sensor noise from a known truth."""
    given = dict(_effect(e) for e in effect or [])
    folder = out if out is not None else Path("ivsid-simulate")
    if truth is None and hide is not None:
        # Beside the log it would lie open before whoever is to find the effect.
        truth = folder.with_name(f"{folder.name}-truth") / "truth.json"
    _run(
        "simulate",
        folder,
        json,
        lambda w, p: w.simulate(
            vehicle, scenario, seed=seed, effects=given, hide=hide, hidden=effects, table=table, progress=p
        ),
        {} if truth is None else {"truth.json": truth},
    )


@app.command()
def allan(
    log: Annotated[Path, typer.Argument(help="Static recording (CSV or Parquet).")],
    out: Out = None,
    json: Json = False,
    columns: Annotated[
        str, typer.Option("--columns", help="Channels, separated by commas; by default every inertial one.")
    ] = "",
    time: Annotated[str | None, typer.Option("--time", help="Name of the time column [s].")] = None,
) -> None:
    """Allan deviation per channel, noise coefficients, bounds, ready for a vehicle file."""
    chosen = [c.strip() for c in columns.split(",") if c.strip()]
    _run("allan", out, json, lambda w, p: w.allan(log, columns=chosen, time=time, progress=p))


@app.command()
def thrust(
    table: Annotated[Path, typer.Argument(help="Bollard-pull table (CSV or Parquet).")],
    out: Out = None,
    json: Json = False,
    demand_column: Annotated[str | None, typer.Option("--demand-column", help="Name of the demand column.")] = None,
    thrust_column: Annotated[str | None, typer.Option("--thrust-column", help="Name of the thrust column.")] = None,
    unit: Annotated[str | None, typer.Option("--unit", help="Unit of the thrust: N, kN, kgf, gf, lbf.")] = None,
) -> None:
    """Thrust models of a bollard-pull table: residuals, and which to use."""
    _run(
        "thrust",
        out,
        json,
        lambda w, p: w.thrust(table, demand_column=demand_column, thrust_column=thrust_column, unit=unit, progress=p),
    )


@app.command()
def identify(
    vehicle: Annotated[Path, typer.Argument(help="Vehicle file (TOML).")],
    log: Annotated[
        Path, typer.Argument(help="Log: CSV, Parquet, .mat, ROS bag, DataFlash .bin, or a folder of tables.")
    ],
    method: Annotated[
        str,
        typer.Option(
            "--method",
            help="feasible, qr, augmented, exact, partitioned, hansen-bliek-rohn, krawczyk, cramer, kuttler, published or published-hull.",
        ),
    ] = "feasible",
    partitions: Annotated[
        int | None, typer.Option("--partitions", min=1, help="N of the published methods, or cells of partitioned.")
    ] = None,
    form: Annotated[
        str, typer.Option("--form", help="total, or added: the rigid-body mass is known and left out.")
    ] = "total",
    rows: Annotated[
        str, typer.Option("--rows", help="auto, pointwise, integral, weak (from a pose) or both: every kind.")
    ] = "auto",
    window: Annotated[
        str, typer.Option("--window", help="Length of integral rows [s], or several at once: 0.5,2,10.")
    ] = "1.0",
    bias: Annotated[
        str,
        typer.Option(
            "--bias",
            help="The accelerometer's bias: sample (a bound at every sample), log (one unknown a log) or auto (log where clearly tighter).",
        ),
    ] = "auto",
    outliers: Annotated[
        int, typer.Option("--outliers", min=0, help="How many rows of each set of parameters may be wrong.")
    ] = 0,
    out: Out = None,
    json: Json = False,
) -> None:
    """Parameter intervals."""
    windows = _lengths(window)
    _run(
        "identify",
        out,
        json,
        lambda w, p: w.identify(
            vehicle,
            log,
            method,
            partitions=partitions,
            form=form,
            rows=rows,
            window=windows,
            bias=bias,
            outliers=outliers,
            progress=p,
        ),
    )


@app.command()
def verify(
    result: Annotated[Path, typer.Argument(help="Folder or result.json of ivsid identify.")],
    log: Annotated[Path, typer.Argument(help="The log that was identified.")],
    out: Out = None,
    json: Json = False,
) -> None:
    """Check an identification's certificates in exact arithmetic, without the core."""
    _run("verify", out, json, lambda w, p: w.verify(result, log, progress=p))


@app.command()
def validate(
    fit: Annotated[Path, typer.Argument(help="Folder or result.json of ivsid identify.")],
    log: Annotated[Path, typer.Argument(help="Another log, as for identify.")],
    out: Out = None,
    json: Json = False,
) -> None:
    """Predicted against measured force and moment, simulated against measured motion."""
    _run("validate", out, json, lambda w, p: w.validate(fit, log, progress=p))


@app.command()
def diagnose(
    vehicle: Annotated[Path, typer.Argument(help="Vehicle file (TOML) with the simulation's [model].")],
    train: Annotated[Path, typer.Argument(help="Log in which causes are looked for.")],
    test: Annotated[Path, typer.Argument(help="Another log, on which the better model is tried.")],
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
    null_logs: Annotated[
        int,
        typer.Option(
            "--null-logs",
            min=0,
            help="Simulated null logs that a finding close to its threshold has to pass, at most; 0: the Gaussian draws alone.",
        ),
    ] = 400,
    no_cache: Annotated[bool, typer.Option("--no-cache", help="Neither read nor keep what null logs gave.")] = False,
) -> None:
    """What the simulation gets wrong, why, the extended model, and what it gains on the other log."""
    _run(
        "diagnose",
        out,
        json,
        lambda w, p: w.diagnose(vehicle, train, test, seed=seed, null_logs=null_logs, cache=not no_cache, progress=p),
    )


@app.command()
def isolability(
    vehicle: Annotated[Path, typer.Argument(help="Vehicle file (TOML).")],
    log: Annotated[
        Path, typer.Argument(metavar="LOG_OR_SCENARIO", help="A log, or a scenario (TOML) that is simulated.")
    ],
    out: Out = None,
    json: Json = False,
    seed: Seed = None,
) -> None:
    """What a programme can detect and tell apart, and the manoeuvre that would help."""
    _run("isolability", out, json, lambda w, p: w.isolability(vehicle, log, seed=seed, progress=p))


@app.command("import")
def import_(
    name: Annotated[str, typer.Argument(metavar="SET", help="cse1, rov30k or t200.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder that holds the data set.")],
    out: Out = None,
    json: Json = False,
) -> None:
    """A public data set as logs, thrust tables and a vehicle file."""
    _run("import", out, json, lambda w, p: w.import_set(name, folder, progress=p))


def _lengths(text: str) -> float | list[float]:
    try:
        lengths = [float(part) for part in text.split(",")]
    except ValueError:
        raise IvsidError(
            f"--window {text} is not understood; write a length in seconds, 1.0, or several, 0.5,2,10"
        ) from None
    return lengths[0] if len(lengths) == 1 else lengths


def _effect(text: str) -> tuple[str, list[float]]:
    id_, _, values = text.partition("=")
    try:
        numbers = [float(v) for v in values.split(",")]
    except ValueError:
        numbers = []
    if not numbers or not all(map(math.isfinite, numbers)):
        raise IvsidError(
            f"--effect {text} is not understood; write ID=VALUE, for example drag.surge.linear=4, or ID=A,B for an effect of "
            "several numbers, for example current.steady=0.08,0.05"
        )
    return id_.strip(), numbers


def _run(
    command: str,
    out: Path | None,
    json: bool,
    work: Callable[[Any, Callable[[str], None]], Any],
    apart: Mapping[str, Path] | None = None,
) -> None:
    """Checks the folder, works, writes, prints; files named in ``apart`` go to places of their own."""
    apart = apart or {}
    folder = out if out is not None else Path(f"ivsid-{command}")
    from ivsid import effects, workflow  # noqa: PLC0415 - the heavy imports wait until a command runs
    from ivsid.files import records  # noqa: PLC0415 - the heavy imports wait until a command runs
    from ivsid.report import page  # noqa: PLC0415 - the heavy imports wait until a command runs

    for place in (folder, *(p.parent for p in apart.values())):
        records.check_writable(place)
    console = Console(stderr=True, quiet=json)
    with console.status(command) as status:
        made = work(workflow, lambda step: status.update(f"{command}: {step}"))
        made = replace(made, record=records.with_own_effects(made.record, effects.own_files()))
        page.write(replace(made, files={n: c for n, c in made.files.items() if n not in apart}), folder)
        for name, place in apart.items():
            records.write_whole(place, made.files[name])
    if json:
        typer.echo(records.to_json(made.record))
        return
    for line in made.lines:
        typer.echo(line)
    for name, place in apart.items():
        typer.echo(f"  {name} stands apart: {place}")
    typer.echo(f"written to {folder}/ (report.html, result.json, {len(made.drawings)} figures)")


def _usage(error: typer.TyperException) -> str:
    """What Typer says of wrong usage, on one line."""
    words = error.format_message() if hasattr(error, "format_message") else str(error)
    return " ".join(words.split())


def main() -> None:
    """The entry point: sentences instead of tracebacks."""
    # What overflows on the way to a refusal is said in that sentence, not by NumPy.
    warnings.filterwarnings("ignore", category=RuntimeWarning)
    command = typer.main.get_command(app)
    try:
        code = command.main(standalone_mode=False)
    except typer.Abort:
        code = 130
    except typer.TyperException as error:
        if words := _usage(error):
            typer.echo(f"ivsid: {words} (ivsid --help shows what is possible)", err=True)
        code = 2
    except IvsidError as error:
        typer.echo(f"ivsid: {error}", err=True)
        code = 2
    except BrokenPipeError:
        code = 0
    except (KeyboardInterrupt, EOFError):
        code = 130
    except MemoryError:
        typer.echo("ivsid: not enough memory for this input; give a shorter log", err=True)
        code = 2
    except Exception as error:
        typer.echo(
            f"ivsid: an internal fault, {type(error).__name__}: {error}; please report it with the command and its files",
            err=True,
        )
        code = 1
    sys.exit(code if isinstance(code, int) else 0)
