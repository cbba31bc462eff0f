"""Public data sets, from a folder of the user's, as logs, thrust tables and a vehicle file.

- ``cse1``: CyberShip Enterprise I, free runs and captive tests.
- ``rov30k``: SUB-fighter 30k, an ROV at sea.
- ``t200``: the Blue Robotics T200, bollard pulls.
- ``kvlcc2``: a tanker's free runs in two basins, HSVA and MARIN, whose tables ``basins`` reads.
- ``imported``: the value that each of them gives, and files of a folder by content.
- ``catman``: recordings of a towing tank; ``captive``: static force tables, and drag as intervals from them.

The chapter may use ``log``, ``files``, ``linear``, ``intervals`` and ``errors``. The data are never part of this package.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from ivsid.adapters.cse1 import read_cse1
from ivsid.adapters.imported import Imported, Part, Table
from ivsid.adapters.kvlcc2 import read_hsva, read_marin
from ivsid.adapters.rov30k import read_rov30k
from ivsid.adapters.t200 import read_t200

ADAPTERS: Final[dict[str, Callable[[Path], Imported]]] = {
    "cse1": read_cse1,
    "hsva": read_hsva,
    "marin": read_marin,
    "rov30k": read_rov30k,
    "t200": read_t200,
}

__all__ = ["ADAPTERS", "Imported", "Part", "Table", "read_cse1", "read_hsva", "read_marin", "read_rov30k", "read_t200"]
