"""The parameters of a fit as vertices: what its certificates leave of its box, without the log that it was made of.

Every row of a certificate is a pair of half-spaces that hold every consistent parameter of its cell of signs (docs/theory.md, "The
feasible set"). Together with the box they bound a polytope, whose vertices follow in fractions. Leaving a row out only makes the
polytope larger, so that its size can be kept in bounds.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import Final, TypeAlias, TypedDict

from ivsid.errors import IvsidError
from ivsid.identification import Identification, Parameter
from ivsid.intervals import Interval, shown
from ivsid.linear.trajectories import Column, Vertex

Point: TypeAlias = tuple[Fraction, ...]
# Half-space: factors, and the most that their sum with a parameter can be.
HalfSpace: TypeAlias = tuple[Point, Fraction]


class Row(TypedDict):
    """A row of a certificate: ends of its entries and of its right-hand side, as hexadecimal floats."""

    lower: list[str]
    upper: list[str]
    right: list[str]


# Most vertices of a set of parameters that share rows. A row that would leave more is left out.
# Source: resource: each vertex costs some 0.1 us a step and channel
MOST_OF_BLOCK: Final = 64
# Most vertices of a channel, over all sets that act in it. Beyond it the sets with most vertices count as boxes.
# Source: resource: as above
MOST_OF_CHANNEL: Final = 256
# Most parameters of a set of which corners are formed; a larger set counts as a box.
# Source: resource: 2^6 corners are MOST_OF_BLOCK
MOST_PARAMETERS: Final = 6


@dataclass(frozen=True)
class Block:
    """Parameters that share rows.

    Attributes:
        ids: of the parameters.
        vertices: of the polytope of what is consistent; none where there are too many parameters to form them.
        rows: number of half-spaces that cut the box.
        box: ends of each parameter.
    """

    ids: tuple[str, ...]
    vertices: tuple[Point, ...]
    rows: int
    box: tuple[tuple[float, float], ...]


def blocks_of(fit: Identification, acting: Collection[str]) -> list[Block]:
    """The parameters of a fit that act on what is followed, set by set.

    Args:
        fit: by ``identify``.
        acting: ids of these parameters.

    Raises:
        IvsidError: a fit without parameters, or without a finite interval of one of these.
    """
    if fit.status == "empty" or not fit.parameters:
        raise IvsidError(
            f"the fit ({fit.method}, {fit.status}) has no parameters to simulate: {fit.reason or 'its set is empty'}; identify again"
        )
    for id_ in acting:
        p = fit.parameters.get(id_)
        if p is None:
            raise IvsidError(
                f"the fit ({fit.method}, {fit.status}) has no interval of {id_}, which acts on what a tube follows: {fit.reason or 'it was left out'}; "
                "identify by the method feasible"
            )
        if not _finite(p):
            raise IvsidError(
                f"{id_} has {'no bound' if not (math.isfinite(p.lower) or math.isfinite(p.upper)) else f'the interval {shown(p.lower, p.upper)}'}, and a tube needs finite ones of all parameters that act on what it follows; "
                "identify with a log that excites it, or follow surge alone with --channels surge or straight where it does not act there"
            )
    found = []
    for ids, rows in _sets(fit, acting):
        whole = _block(ids, rows, _box(fit, ids))
        if whole is None:
            raise IvsidError("the certificates of the fit contradict each other; identify again")
        found.append(whole)
    return found


def _finite(p: Parameter) -> bool:
    return math.isfinite(p.lower) and math.isfinite(p.upper) and p.lower <= p.upper


def pieces_of(fit: Identification, acting: Collection[str], count: int) -> list[list[Block]]:
    """The parameters of a fit in pieces that cover them: for each piece its sets.

    Args:
        fit: with finite intervals of these parameters.
        acting: ids of the parameters that act on what is followed, whose intervals are cut.
        count: equal parts into which each interval is cut.
    """
    choices: list[list[Block]] = []
    for ids, rows in _sets(fit, acting):
        ends = _box(fit, ids)
        slices = [[(a + (b - a) * k / count, a + (b - a) * (k + 1) / count) for k in range(count)] for a, b in ends]
        made = [_block(ids, rows, choice) for choice in product(*slices)]
        choices.append([b for b in made if b is not None])
    return [list(choice) for choice in product(*choices)]


def _sets(fit: Identification, acting: Collection[str]) -> list[tuple[tuple[str, ...], tuple[HalfSpace, ...]]]:
    """Ids of each set of parameters that share rows, with the half-spaces of its certificates.

    A set with an open interval has no corners: those of its parameters that act stand alone, each with its interval.
    """
    try:
        held = _cells(fit)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        # Of a result that was edited: the checker looks at certificates, a reader of results does not.
        raise IvsidError(f"a certificate of the fit cannot be read ({type(error).__name__}); identify again") from None
    cells = {ids: rows for ids, rows in held.items() if all(_finite(fit.parameters[i]) for i in ids)}
    chosen = {ids: rows for ids, rows in cells.items() if set(ids) & set(acting)}
    rest = [i for i in fit.parameters if i in acting and not any(i in ids for ids in chosen)]
    return [*chosen.items(), *(((i,), ()) for i in rest)]


def _box(fit: Identification, ids: Sequence[str]) -> list[tuple[Fraction, Fraction]]:
    return [(Fraction(fit.parameters[i].lower), Fraction(fit.parameters[i].upper)) for i in ids]


def _cells(fit: Identification) -> dict[tuple[str, ...], tuple[HalfSpace, ...]]:
    """Half-spaces by set of parameters, where a single cell of signs holds all of it and no row may be wrong."""
    if fit.method != "feasible" or fit.options.get("outliers"):
        return {}
    bounding: dict[tuple[str, ...], dict[tuple[int, ...], list[Row]]] = {}
    for c in fit.certificates:
        if c["proves"] == "bound" and set(c["orthant"]) <= set(fit.parameters):
            cells = bounding.setdefault(tuple(c["orthant"]), {})
            cells.setdefault(tuple(c["orthant"].values()), []).extend(c["rows"])
    made: dict[tuple[str, ...], tuple[HalfSpace, ...]] = {}
    for ids, cells in bounding.items():
        if len(cells) == 1 and not any(set(ids) & set(other) for other in bounding if other != ids):
            ((signs, rows),) = cells.items()
            if all(signs) and all(len(r["lower"]) == len(ids) for r in rows):
                made[ids] = tuple(dict.fromkeys(h for r in rows for h in _half_spaces(r, signs)))
    return made


def _half_spaces(row: Row, signs: Sequence[int]) -> list[HalfSpace]:
    """Least and most of the row over the cell: least <= upper end of the right-hand side, most >= its lower end; open ends say nothing."""
    right = [float.fromhex(x) for x in row["right"]]
    if not all(math.isfinite(float.fromhex(x)) for end in (row["lower"], row["upper"]) for x in end):
        return []
    low, high = ([Fraction(float.fromhex(x)) for x in end] for end in (row["lower"], row["upper"]))
    least = tuple(a if s > 0 else b for a, b, s in zip(low, high, signs, strict=True))
    most = tuple(-(b if s > 0 else a) for a, b, s in zip(low, high, signs, strict=True))
    found = []
    if math.isfinite(right[1]):
        found.append((least, Fraction(right[1])))
    if math.isfinite(right[0]):
        found.append((most, -Fraction(right[0])))
    return found


def _block(ids: tuple[str, ...], rows: Sequence[HalfSpace], ends: Sequence[tuple[Fraction, Fraction]]) -> Block | None:
    """The part of a box that the half-spaces leave; None where they leave nothing."""
    box = tuple((down(a), up(b)) for a, b in ends)
    if len(ids) > MOST_PARAMETERS:
        return Block(ids, (), 0, box)
    # A corner with the numbers of the bounds that are tight there: 2 j for the lower end of parameter j, 2 j + 1 for the upper.
    corners: dict[Point, frozenset[int]] = {
        tuple(e[c] for e, c in zip(ends, choice, strict=True)): frozenset(2 * j + c for j, c in enumerate(choice))
        for choice in product((0, 1), repeat=len(ids))
    }
    used = 0
    for number, half in enumerate(sorted(rows, key=lambda h: -_cut(h, ends)), start=2 * len(ids)):
        clipped = _clipped(corners, half, number, len(ids))
        if len(clipped) <= max(MOST_OF_BLOCK, len(corners)):
            used += len(clipped.keys() - corners.keys()) > 0
            corners = clipped
        if not corners:
            return None
    return Block(ids, tuple(corners), used, box)


def _cut(half: HalfSpace, ends: Sequence[tuple[Fraction, Fraction]]) -> Fraction:
    """How far the half-space reaches into the box, as a share of its own range there."""
    most = sum(max(f * a, f * b) for f, (a, b) in zip(half[0], ends, strict=True))
    least = sum(min(f * a, f * b) for f, (a, b) in zip(half[0], ends, strict=True))
    return (most - half[1]) / (most - least) if most > least else Fraction(0)


def _clipped(
    corners: Mapping[Point, frozenset[int]], half: HalfSpace, number: int, dimension: int
) -> dict[Point, frozenset[int]]:
    """The vertices of the polytope inside a half-space (double description: Motzkin and others 1953).

    An edge that is cut has its ends on opposite sides, and they share at least ``dimension - 1`` tight bounds. A pair that meets this and is
    no edge only adds a point inside.
    """
    # A point of fractions is slow to look up, so that each is once.
    over = [(p, tight, sum(f * x for f, x in zip(half[0], p, strict=True)) - half[1]) for p, tight in corners.items()]
    kept = {p: tight | {number} if by == 0 else tight for p, tight, by in over if by <= 0}
    if len(kept) == len(corners):
        return kept
    inside, outside = [c for c in over if c[2] < 0], [c for c in over if c[2] > 0]
    for (p, near, low), (q, far, high) in product(inside, outside):
        shared = near & far
        if len(shared) >= dimension - 1:
            share = high / (high - low)
            point = tuple(y + share * (x - y) for x, y in zip(p, q, strict=True))
            kept[point] = kept.get(point, frozenset()) | shared | {number}
    return kept


def down(x: Fraction) -> float:
    """The largest double that is not above."""
    near = float(x)
    return near if Fraction(near) <= x else math.nextafter(near, -math.inf)


def up(x: Fraction) -> float:
    """The smallest double that is not below."""
    return -down(-x)


def vertices_of(
    blocks: Sequence[Block], ids: Sequence[str], known: Sequence[Interval], channel: Sequence[Column]
) -> list[Vertex]:
    """The vertices of all parameters that act in a channel, each as a box; others are 0 there.

    Args:
        blocks: of the fit.
        ids: of the terms, in their order.
        known: numbers of the rigid body, which stand after the terms.
        channel: its columns.
    """
    acting = {number for number, _, _ in channel}
    choices: list[list[dict[str, tuple[float, float]]]] = []
    boxes: list[dict[str, tuple[float, float]]] = []
    for block in blocks:
        inside = [i for i in block.ids if ids.index(i) in acting]
        if not inside:
            continue
        places = [block.ids.index(i) for i in inside]
        points = list(dict.fromkeys(tuple(p[j] for j in places) for p in block.vertices))
        whole = {i: block.box[j] for i, j in zip(inside, places, strict=True)}
        boxes.append(whole)
        made = [{i: (down(x), up(x)) for i, x in zip(inside, p, strict=True)} for p in _outermost(points)]
        choices.append(made or [whole])
    while math.prod(len(c) for c in choices) > MOST_OF_CHANNEL:
        largest = max(range(len(choices)), key=lambda k: len(choices[k]))
        choices[largest] = [boxes[largest]]
    found: list[Vertex] = []
    for choice in product(*choices):
        merged = {i: ends for part in choice for i, ends in part.items()}
        ends = [merged.get(i, (0.0, 0.0)) for i in ids]
        ends += [(k.lower, k.upper) if len(ids) + j in acting else (0.0, 0.0) for j, k in enumerate(known)]
        found.append(([a for a, _ in ends], [b for _, b in ends]))
    return found


def _outermost(points: list[Point]) -> list[Point]:
    """Points of one dimension reduced to their ends; those of more dimensions stay, since a point inside does no harm."""
    if points and len(points[0]) == 1:
        return sorted({min(points), max(points)})
    return points


def members_of(blocks: Sequence[Block], ids: Sequence[str], known: Sequence[Interval], most: int) -> list[list[float]]:
    """Single parameters in plain floats, of the outermost members: combinations of the blocks' vertices, evenly spaced ones where there are more.

    Parameters that act on nothing that is followed are 0.
    """
    choices = [
        [[float(x) for x in p] for p in b.vertices] or [[a for a, _ in b.box], [e for _, e in b.box]] for b in blocks
    ]
    total = math.prod(len(c) for c in choices)
    picked = range(total) if total <= most else sorted({round(k * (total - 1) / (most - 1)) for k in range(most)})
    found = []
    for number in picked:
        values: dict[str, float] = {}
        for block, choice in zip(blocks, choices, strict=True):
            number, place = divmod(number, len(choice))  # noqa: PLW2901 - the digits of the number are the choices
            values |= zip(block.ids, choice[place], strict=True)
        found.append([values.get(i, 0.0) for i in ids] + [float(k.midpoint) for k in known])
    return found
