"""SUB-fighter 30k, a work-class ROV at sea (NTNU, 18 May 2015): Doppler log, IMU, acoustic position, demands.

Expected in the folder: ``*_decoded.csv.gz`` (one row a control cycle) and ``*_deck_imu.csv.gz`` (the same IMU at rest).
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from ivsid.adapters.imported import Imported, Part, digests, files_in
from ivsid.errors import IvsidError
from ivsid.log import open_source

Array = NDArray[np.float64]

TITLE: Final = "the SUB-fighter 30k logs (*_decoded.csv.gz and *_deck_imu.csv.gz)"
ORIGIN: Final = "github.com/NTNU-MCS/CS_EnterpriseI_archive, decoded"
# The Doppler log's marker of an invalid velocity [m/s]: the least 16-bit integer, in mm/s.
# Source: definition: size of the data type
INVALID: Final = -32.768
# Begin and end of each usable segment [s], read off the demands: the vehicle is at rest before 60 s; after 1930 s the Doppler log is
# lost and the demands saturate.
# Source: definition: the published set
SEGMENTS: Final = {"manual": (60.0, 690.0), "automatic": (700.0, 1930.0)}
# Channel, column of the set, and sign: the gyro's z axis points up.
MAP: Final = (
    ("u", "u_dvl_mps", 1.0),
    ("v", "v_dvl_mps", 1.0),
    ("r", "gyr_z_radps", -1.0),
    ("psi", "eta_mes_psi", 1.0),
    ("x", "north_rel_m", 1.0),
    ("y", "east_rel_m", 1.0),
    ("demand_port", "rpm_port", 1.0),
    ("demand_starboard", "rpm_stbd", 1.0),
    ("demand_lateral", "rpm_side", 1.0),
)
GYRO: Final = ("gyr_x", "gyr_y", "gyr_z")


def read_rov30k(folder: Path) -> Imported:
    """The two usable segments of the dive as logs, and the bias of the gyro on deck.

    Raises:
        IvsidError: a file is missing or damaged; one sentence names it.
    """
    (dives, decks) = files_in(folder, ["*_decoded.csv.gz", "*_deck_imu.csv.gz"], TITLE, ORIGIN)
    dive, deck = dives[0], decks[0]
    with open_source(dive) as source:
        cells = source.numeric(["t_s", *(c for _, c, _ in MAP)])
    t = cells["t_s"]
    if t.size < 2 or not (np.diff(t) > 0).all():
        raise IvsidError(f"{dive}: the times t_s do not increase; give the set as it is published")
    columns = {name: sign * cells[c] for name, c, sign in MAP}
    invalid = (cells["u_dvl_mps"] == INVALID) | (cells["v_dvl_mps"] == INVALID)
    for name in ("u", "v"):
        columns[name] = np.where(invalid, np.nan, columns[name])
    logs = {name: _segment(t, columns, invalid, *span) for name, span in SEGMENTS.items()}
    with open_source(deck) as source:
        gyro = source.numeric(["t_s", *GYRO])
    steps = np.diff(t)
    facts: dict[str, object] = {
        "samples": int(t.size),
        "period": float(np.median(steps)),
        "longest_gap": float(steps.max()),
        "invalid_velocity": int(invalid.sum()),
        "deck_duration": float(gyro["t_s"][-1] - gyro["t_s"][0]),
        "gyro_bias": [float(gyro[c].mean()) for c in GYRO],
        "rejected_after": SEGMENTS["automatic"][1],
    }
    rejected = t > SEGMENTS["automatic"][1]
    return Imported(
        title="SUB-fighter 30k ROV",
        logs=logs,
        vehicle="rov30k.toml",
        facts=facts,
        notes=(
            f"after {SEGMENTS['automatic'][1]:g} s the segment is rejected: the Doppler log is invalid in {int((invalid & rejected).sum())} of "
            f"{int(rejected.sum())} rows and the demands saturate",
            "Doppler and acoustic values are held between new ones, about one a second; a value counts at the row where it first "
            "stands, so its own delay is not in the log",
            "accelerations are left out: the IMU's axes are rolled about 12 degrees against the body's, and gravity is in them",
            f"the deck recording {deck.name} is ready for ivsid allan as it is; the gyro's bias there is not subtracted, "
            "but inside the accuracy of the vehicle file",
        ),
        inputs=digests(folder, [dive, deck]),
    )


def _segment(t: Array, columns: dict[str, Array], invalid: NDArray[np.bool_], begin: float, end: float) -> Part:
    inside = (t >= begin) & (t < end)
    part = {name: values[inside] for name, values in columns.items()}
    gone = int(invalid[inside].sum())
    notes = (f"{gone} invalid Doppler samples are missing",) if gone else ()
    return Part(t[inside], part, notes)
