"""One sealed case through the diagnosis and its peers: from the folder alone."""

from __future__ import annotations

import time
import traceback
from pathlib import Path


def examine(folder: Path) -> dict:
    """The diagnosis of the files of a folder, its time, and the results of the peers."""
    from tests.exam.peers import PEERS, regression

    from ivsid.diagnosis import diagnose
    from ivsid.log import read_log
    from ivsid.vehicle import read_vehicle

    vehicle = read_vehicle(folder / "vehicle.toml")
    train, test = (read_log(folder / f"{k}.csv", vehicle.log) for k in (1, 2))
    start = time.process_time()
    try:
        d = diagnose(vehicle, train, test)
    except Exception:
        return {"crash": traceback.format_exc()}
    spent = time.process_time() - start
    others = regression(vehicle, train)
    return {
        "record": d.record(),
        "cpu": spent,
        "visible": {i: v.z for i, v in d.visible.items()},
        "left": [(s.id, round(s.fall, 1)) for s in d.selection.leftover[:4]],
        "adequacy": [(a.fall, a.freedom, a.chance, a.chance_of_one, a.strongest[:2]) for a in d.adequacy],
        "peers": {name: peer(others) for name, peer in PEERS.items()},
    }
