"""``ivsid diagnose``: causes of the simulation's errors, and the extended model on another log."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ivsid import diagnosis
from ivsid.diagnosis import GUARANTEED, NULL_LOGS, REFUTED, Claim, Diagnosis, cache_folder
from ivsid.intervals import shown
from ivsid.intervals.apart import Apart
from ivsid.log import read_log
from ivsid.report import figures, page
from ivsid.report.page import Part, Report, Section
from ivsid.vehicle import read_vehicle
from ivsid.workflow.progress import Progress, silent
from ivsid.workflow.set_up import examined, with_setup

VERDICTS = {
    "adequate": "Nothing beyond the declared errors: the simulation is adequate for what this log could show.",
    "wrong": "The simulation is wrong; the findings name the causes, strongest first.",
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
    logs = [read_log(p, checked.log) for p in (train, test)]
    findings = examined(checked, logs, progress)
    result = diagnosis.diagnose(
        checked,
        *logs,
        seed=1 if seed is None else seed,
        progress=progress,
        null_logs=null_logs,
        cache=cache_folder() if cache else None,
    )
    progress("drawing")
    return with_setup(diagnosis_report(result), findings)


def diagnosis_report(result: Diagnosis) -> Report:
    """The report of a diagnosis."""
    # Another process draws some of the figures, while this one makes the tables and draws the rest.
    beside = Apart(lambda: (figures.net_force(result.gain), figures.gain(result.gain)))
    seen = diagnosis.evidence(result)
    signatures = {e.effect: figures.signature(e, f"signature_{k}") for k, e in enumerate(seen, start=1)}
    # A cause found between the two logs has no signature in one of them.
    signatures |= {f.effect: figures.ratios(f) for f in result.findings if "ratio" in f.evidence}
    explained, record = diagnosis.explain(result, seen), result.record()
    after = [
        Section("Numbers that the vehicle file gives", (_claims(result),) if result.claims else ()),
        Section("Candidates that are no findings", (_candidates(result),)),
        Section("Causes that this log could not show", (_untested(result), _allowed(result))),
        Section("Proved without a noise model", (page.bullets(_proved(result)),)),
        Section("Assumptions", (page.bullets(_assumptions(result)),)),
    ]
    files = {**diagnosis.model_files(result), **_certificates(result)}
    residual = figures.force_residual(result.gain)
    others = (*beside.result(), residual)
    told: list[Part] = []
    for f, paragraphs in zip(result.findings, explained, strict=True):
        told += map(page.text, paragraphs)
        if f.effect in signatures:
            told.append(page.drawing(signatures[f.effect]))
    sections = [
        Section("Findings", (_findings(result), *told)),
        Section("Gain of the extended model", (*_told(result), _gain(result), *map(page.drawing, others))),
        *after,
    ]
    if result.hints:
        sections.insert(1, Section("Hints: inside the declared errors", (page.bullets(result.hints),)))
    summary = f"{result.vehicle.name}: {result.verdict}. {VERDICTS[result.verdict]}"
    if result.proofs[0].refuted:
        summary += f" {REFUTATION}"
    summary = " ".join([*_worse(result), summary])
    return Report(
        f"Diagnosis of {result.vehicle.name}",
        summary,
        record,
        tuple(s for s in sections if s.parts),
        (*signatures.values(), *others),
        files,
        tuple(_lines(result)),
    )


def _worse(result: Diagnosis) -> list[str]:
    """What is worse on the other log, or diverges: it stands first."""
    return [words for words in (diagnosis.diverging(result.gain), diagnosis.lost(result.gain)) if words]


def _model(result: Diagnosis) -> str:
    """Whether there is a file of the extended model, and why there is none."""
    why = result.against_model
    return f"no model.toml is written: {'; '.join(why)}" if why else "model.toml holds the extended model"


def _told(result: Diagnosis) -> list[Part]:
    return [page.text(words) for words in (*_worse(result), _model(result))]


def _findings(result: Diagnosis) -> Part:
    rows = []
    for f in result.findings:
        bounds = "; ".join(
            f"{k} {shown(b.lower, b.upper)} {b.unit}{' (guaranteed)' if b.guaranteed else ''}"
            for k, b in f.parameters.items()
        )
        sure = None if f.like is None else f.like.probability
        rows.append(
            [f.effect, sure, f.confidence, bounds or "–", ", ".join(f.alternatives) or "–", f.separate_by or "–"]
        )
    header = [
        "cause",
        "probability of the set",
        "weight in its set",
        "parameters",
        "could also be",
        "trial that would separate them",
    ]
    return page.table(header, rows, "No finding." if not rows else "Intervals are statistical unless marked.")


def _gain(result: Diagnosis) -> Part:
    rows = [
        [f"{what} [{unit}]", before, after, *(interval or (None, None)), said]
        for what, unit, before, after, interval, said in diagnosis.worth(result.gain)
    ]
    header = ["on the other log", "before", "after", "before/after from", "to", "so it is"]
    caption = "Medians over windows, rms for forces; 95 % intervals of before/after by drawing windows anew. A loss is a loss."
    return page.table(header, rows, caption)


def _candidates(result: Diagnosis) -> Part:
    rows = [
        [
            r.effect,
            r.fall,
            r.numbers,
            r.chance,
            None if r.full is None else f"{r.full[0]:.0f} of {r.full[1]:.0f}",
            r.beside,
            r.reason,
        ]
        for r in result.rejected[:20]
    ]
    header = [
        "cause",
        "fall of chi² alone",
        "numbers",
        "chance without it",
        "in a finding's place",
        "left beside the findings",
        "why it is none",
    ]
    return page.table(header, rows, "The twenty that came nearest; result.json has them all.")


def _claims(result: Diagnosis) -> Part:
    rows = [
        [
            c.parameter,
            f"{c.value:g} {c.unit}",
            c.z,
            *("–" if b is None else shown(b.lower, b.upper) for b in (c.beside, c.alone)),
            _said(c),
        ]
        for c in result.claims
    ]
    header = ["number", "claimed", "away [σ]", "the log, other claims held", "the log alone", "so it is"]
    caption = "Statistical intervals; they hold what a cause that was not found may hide. A claim is a finding only where nothing else could move it."
    return page.table(header, rows, caption)


def _said(claim: Claim) -> str:
    if claim.beside is None:
        return claim.reason
    if claim.contradicted:
        return "contradicted: a finding"
    if claim.beside.lower <= claim.value <= claim.beside.upper:
        return "not contradicted"
    return "outside of the interval, and no finding: too little of the rest is explained, or too little of it is there"


def _untested(result: Diagnosis) -> Part:
    return page.table(
        ["effect", "why not", "needs"], [[q["effect"], q["reason"], q["needs"]] for q in result.not_tested]
    )


def _allowed(result: Diagnosis) -> Part:
    least = {k: v for q in result.visible.values() if q.tested for k, v in q.detectable.items()}
    rows = [
        [name, f"{shown(b.lower, b.upper)} {b.unit}", f"{abs(least[name]):.3g}" if name in least else "not tested"]
        for name, b in result.allowed.items()
    ]
    caption = "Causes that are no findings, each alone beside the extended model: statistical intervals of what may be there all the same."
    return page.table(["number", "the log allows", "would have shown from"], rows, caption)


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
    lines = [f"  {w}" for w in _worse(result)]
    if result.proofs[0].refuted:
        lines.append(f"  {result.proofs[0].sentence(result.verdict)}")
    for f in result.findings:
        also = f", weight {f.confidence:.2f}; could also be {', '.join(f.alternatives)}" if f.alternatives else ""
        lines.append(f"  {f.effect} (probability {0.0 if f.like is None else f.like.probability:.2f}{also})")
        lines += [
            f"    {k:<32} {shown(b.lower, b.upper):>32} {b.unit}{' (guaranteed)' if b.guaranteed else ''}"
            for k, b in f.parameters.items()
        ]
        if f.separate_by:
            lines.append(f"    to separate them: {f.separate_by}")
    if result.findings:
        for what, unit, before, after, _, said in diagnosis.worth(result.gain)[:4]:
            lines.append(f"  {what} on {result.gain.log}: {before:.4g} {unit} before, {after:.4g} after: {said}")
    lines.append(f"  {_model(result)}")
    if result.claims:
        wrong = [c.parameter for c in result.claims if c.contradicted]
        lines.append(f"  {len(result.claims)} claims held against the log, contradicted: {', '.join(wrong) or 'none'}")
    lines.append(
        f"  {len(result.visible) - sum(v.z < 8 for v in result.visible.values())} effects tested, "
        f"{len(result.not_tested)} not (result.json says why)"
    )
    return lines
