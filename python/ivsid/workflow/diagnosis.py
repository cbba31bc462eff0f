"""``ivsid diagnose``: causes of the simulation's errors, and the extended model on another log."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from ivsid import diagnosis
from ivsid.diagnosis import GUARANTEED, NULL_LOGS, REFUTED, Diagnosis, Evidence, Finding, cache_folder
from ivsid.intervals import shown
from ivsid.intervals.apart import Apart
from ivsid.log import Log, read_log
from ivsid.report import figures, page
from ivsid.report.figures import Drawing
from ivsid.report.page import Part, Report, Section
from ivsid.vehicle import Vehicle, read_vehicle
from ivsid.workflow.diagnosis_screen import best_gain, first_screen, size, worse
from ivsid.workflow.diagnosis_series import change_bars, claim_bars, finding_parts, row_links, test_series, train_series
from ivsid.workflow.diagnosis_tables import allowed_table, candidates_table, claims_table, gain_table, untested_table
from ivsid.workflow.gain_figures import GainFigures, drawn_beside, drawn_in_turn
from ivsid.workflow.log_files import distinct_names
from ivsid.workflow.progress import Progress, silent
from ivsid.workflow.set_up import with_setup

VERDICTS = {
    "adequate": "Nothing beyond the declared errors: the simulation is adequate for what this log could show.",
    "wrong": "The simulation lacks what the findings name, strongest first.",
    "unknown": "Something is wrong that no known cause explains.",
}

REFUTATION = "It is proved that no numbers of the model explain the log inside the declared bounds."


def diagnose(
    vehicle: str | Path,
    train: str | Path,
    test: str | Path,
    *,
    seed: int | None = None,
    null_logs: int = NULL_LOGS,
    cache: bool = True,
    progress: Progress = silent,
) -> Report:
    """Reads a vehicle file and two logs, diagnoses and reports.

    Raises:
        IvsidError: an unusable file, in one sentence.
    """
    progress("reading")
    checked = read_vehicle(vehicle)
    paths = (train, test)
    logs = [replace(read_log(p, checked.log), name=name) for p, name in zip(paths, distinct_names(paths), strict=True)]
    return diagnosed(
        checked,
        *logs,
        seed=1 if seed is None else seed,
        null_logs=null_logs,
        cache=cache_folder() if cache else None,
        progress=progress,
    )


def diagnosed(
    vehicle: Vehicle,
    train: Log,
    test: Log,
    *,
    seed: int = 1,
    null_logs: int = NULL_LOGS,
    cache: Path | None = None,
    progress: Progress = silent,
) -> Report:
    """Diagnoses two logs and reports; the figures of a model that stands on the other log are drawn while statements are made.

    Raises:
        IvsidError: logs that cannot be diagnosed, in one sentence.
    """
    drawn = GainFigures()
    try:
        result = diagnosis.diagnose(
            vehicle, train, test, seed=seed, progress=progress, null_logs=null_logs, cache=cache, tried=drawn
        )
        progress("drawing")
        return diagnosis_report(result, drawn)
    finally:
        drawn.end()


def diagnosis_report(result: Diagnosis, drawn: GainFigures | None = None) -> Report:
    """The report of a diagnosis.

    Args:
        result: the diagnosis.
        drawn: figures of its gain that are drawn already; by default another process draws some of them while this one makes the tables.
    """
    figures_of_gain = drawn_beside(result.gain) if drawn is None else partial(drawn.of, result.gain)
    seen = diagnosis.evidence(result)
    signatures = _signatures(seen, result.findings)
    # Another process draws while this one makes the tables.
    begin = _drawn_apart if drawn is None else drawn.beside
    drawn_signatures = begin(signatures)
    sections = [
        Section("Findings", tuple(_findings(result, seen))),
        Section("Hints: what the log shows of declared errors", (page.bullets(result.hints),) if result.hints else ()),
        Section("The log in time", (train_series(result, seen),)),
        Section(
            "Gain of the extended model",
            (*map(page.text, (*worse(result), _model(result))), gain_table(result), test_series(result)),
        ),
        Section("Numbers that the vehicle file gives", _claims(result)),
        Section("What changed between the logs", tuple(change_bars(result))),
        Section(
            "Candidates that are no findings",
            (page.details("The twenty that came nearest", (candidates_table(result),)),),
        ),
        Section(
            "Causes that this log could not show",
            (untested_table(result), page.details("What may be there all the same", (allowed_table(result),))),
        ),
        Section("Proved without a noise model", tuple(_proofs(result))),
        Section("Assumptions", (page.bullets(_assumptions(result)),)),
    ]
    record = result.record()
    files = {**diagnosis.model_files(result), **_certificates(result)}
    report = Report(
        f"Diagnosis of {result.vehicle.name}",
        _summary(result),
        record,
        tuple(s for s in sections if s.parts),
        (*drawn_signatures(), *figures_of_gain()),
        files,
        tuple(_lines(result)),
        first_screen(result),
    )
    return with_setup(report, result.setup)


def _signatures(seen: Sequence[Evidence], findings: Sequence[Finding]) -> list[Callable[[], Drawing]]:
    """What draws the causes: each that one log shows, and those that were found between the two logs."""
    return [
        *(partial(figures.signature, e, f"signature_{k}") for k, e in enumerate(seen, start=1)),
        *(partial(figures.ratios, f) for f in findings if "ratio" in f.evidence),
    ]


def _drawn_apart(draws: Sequence[Callable[[], Drawing]]) -> Callable[[], tuple[Drawing, ...]]:
    task = partial(drawn_in_turn, draws)
    return Apart(task).result if draws else task


def _model(result: Diagnosis) -> str:
    """Whether there is a file of the extended model, and why there is none."""
    why = result.against_model
    return f"no model.toml is written: {'; '.join(why)}" if why else "model.toml holds the extended model"


def _summary(result: Diagnosis) -> str:
    """The verdict with its causes and the gain in a few sentences."""
    words = [f"{result.vehicle.name}: {result.verdict}. {VERDICTS[result.verdict]}"]
    named = [
        f"{f.name} ({', '.join(size(b) for b in f.parameters.values())})" if f.parameters else f.effect
        for f in result.findings
    ]
    if named:
        words.append(f"Findings: {'; '.join(named)}.")
        words.append(best_gain(result))
    if result.proofs[0].refuted:
        words.append(REFUTATION)
    return " ".join(w for w in words if w)


def _findings(result: Diagnosis, seen: Sequence[Evidence]) -> list[Part]:
    """Each finding under its own heading: in words, in the log, and what stands behind it."""
    shown_in = {e.effect: e for e in seen}
    parts: list[Part] = [] if result.findings else [page.text("No finding.")]
    for k, (f, paragraphs) in enumerate(zip(result.findings, diagnosis.explain(result, seen), strict=True), start=1):
        parts.append(page.heading(f.name, f"finding-{k}"))
        # What is said of certainty and of rivals counts in falls of chi-squared, which a reader may open.
        inner = [w for w in paragraphs if w.startswith(("How sure", "What else", "What would"))]
        parts += [page.text(w) for w in paragraphs if w not in inner]
        parts += finding_parts(f, shown_in.get(f.effect))
        if inner:
            parts.append(
                page.details("How sure, what else it could be, and what would change this", map(page.text, inner))
            )
    return parts


def _claims(result: Diagnosis) -> tuple[Part, ...]:
    if not result.claims:
        return ()
    return claim_bars(result.claims), page.details("The claims as a table", (claims_table(result),))


def _proofs(result: Diagnosis) -> list[Part]:
    rows = result.proofs[0].contradiction
    return [page.bullets(_proved(result)), *([row_links(rows)] if rows else [])]


def _assumptions(result: Diagnosis) -> list[str]:
    c = result.calibration
    words = [
        f"probability of any false finding: {c['family_wise']} ({c['method']})",
        *_null_logs(c["simulated"], "a finding", "made a finding"),
        *_null_logs(c["structure"], "structure", "been unknown at the threshold of theory"),
        "declared errors inside their bounds are no findings: sensor biases and scale, smooth thrust errors, ambient force",
    ]
    return [*words, *result.notes]


def _certificates(result: Diagnosis) -> dict[str, str]:
    """Results of ``identify``, for ``ivsid verify``: of the refuted model, and of the one whose intervals are guaranteed."""
    plain, extended = result.proofs
    files = {REFUTED: plain.certificate} if plain.refuted else {}
    if extended is not None and any(b.guaranteed or b.proved for f in result.findings for b in f.parameters.values()):
        files[GUARANTEED] = extended.certificate
    return files


def _proved(result: Diagnosis) -> list[str]:
    plain, extended = result.proofs
    said = plain.record()
    words = [plain.sentence(result.verdict)] if plain.refuted else []
    words += result.moved
    if plain.refuted:
        words.append(f"the certificate stands in {REFUTED}: ivsid verify {REFUTED} {result.inputs[1][0]}")
    elif plain.status == "not_refuted":
        words.append(
            f"the model as it was is not refuted: at {said['inflation']:.3g} of the declared bounds some numbers of it explain every row"
            if said["inflation"] is not None
            else "the model as it was is not refuted"
        )
    else:
        words.append(f"nothing is proved of the model as it was: {said['reason']}")
    if extended is not None and GUARANTEED in _certificates(result):
        for f in result.findings:
            for k, b in f.parameters.items():
                ends = (b.lower, b.upper) if b.guaranteed else b.proved
                if ends is not None:
                    words.append(f"{k} in {shown(*ends)} {b.unit}, whatever the noise inside its bounds")
        words.append(f"these intervals are proved, if: {'; '.join(extended.record()['assumes'])}")
        words.append(f"their certificates stand in {GUARANTEED}: ivsid verify {GUARANTEED} {result.inputs[1][0]}")
    elif extended is not None and extended.refuted:
        words.append("the extended model is refuted inside the declared bounds as well, so no interval is guaranteed")
    return words


def _null_logs(said: dict[str, Any] | None, of: str, done: str) -> list[str]:
    if said is None or not said["logs"]:
        return []
    return [
        f"{said['logs']} null logs were simulated for {of} close to its threshold ({said['cached']} of them earlier): "
        f"a share of {said['achieved']:.3g} of them would have {done}"
    ]


def _lines(result: Diagnosis) -> list[str]:
    lines = [f"  {w}" for w in worse(result)]
    if result.proofs[0].refuted:
        lines.append(f"  {result.proofs[0].sentence(result.verdict)}")
    lines += [f"  {w}" for w in result.moved]
    for f in result.findings:
        also = f", weight {f.confidence:.2f}; could also be {', '.join(f.alternatives)}" if f.alternatives else ""
        lines.append(f"  {f.name} (probability {0.0 if f.like is None else f.like.probability:.2f}{also})")
        lines += [
            f"    {k:<32} {b.stands_for or shown(b.lower, b.upper):>32} {'' if b.stands_for else b.unit}{' (guaranteed)' if b.guaranteed else ''}".rstrip()
            for k, b in f.parameters.items()
        ]
        if f.description:
            lines.append(f"    {f.description}")
        if f.separate_by:
            lines.append(f"    to separate them: {f.separate_by}")
    if result.findings:
        for what, unit, before, after, _, said in diagnosis.worth(result.gain)[:4]:
            # One model has one error.
            change = (
                f" before, {after:.4g} after: {said}" if before != after else "" if said == "unchanged" else f": {said}"
            )
            lines.append(f"  {what} on {result.gain.log}: {before:.4g} {unit}{change}")
    lines += [f"  hint: {h}" for h in result.hints]
    lines.append(f"  {_model(result)}")
    if result.claims:
        wrong = [c.parameter for c in result.claims if c.contradicted]
        lines.append(f"  {len(result.claims)} claims held against the log, contradicted: {', '.join(wrong) or 'none'}")
    lines.append(
        f"  {len(result.visible) - sum(v.z < 8 for v in result.visible.values())} effects tested, "
        f"{len(result.not_tested)} not (result.json says why)"
    )
    return lines
