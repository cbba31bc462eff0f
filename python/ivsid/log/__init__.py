"""Logs: files of many kinds to checked channels in SI units and the axes of the equations of motion.

Files to tables:

- ``formats``: tells the kinds of files apart and opens them; ``source``: the tables that it opens.
- ``text`` (``beginning``; ``instruments`` and ``aligned`` columns), ``parquet``, ``json_text`` with ``json_tables``, ``moos``, ``matlab``, ``rosbag``, ``dataflash``: one file a format. ``parts`` has the bytes of a file that are needed, by ``mcap_index`` or
  the footer of Parquet; ``mcap_mend`` makes an index anew. ``matlab_structure`` refuses damage that SciPy's reader does not
  survive; ``polars_panics`` keeps reports of internal faults of Polars off the terminal.

Tables to a log:

- ``rules``: where each channel comes from; ``headers``: units in the headers; ``arithmetic``: formulas of columns.
- ``channels``: cells to channels: scales, missing markers, frames, heading from attitude.
- ``markers``: numbers that mark a missing sample.
- ``stamps``: stamps to seconds, without losing digits; ``dates``: stamps that are words; ``serial_days``: stamps in days; ``disorder``: stamps out of order, as gaps.
- ``clocks``: samples of one clock on the rows of another. ``one_clock`` does so for every channel.
- ``step_ranges``: the range of a force or an angle over the step between two rows.
- ``angles``, ``turning``: angles followed through whole turns; the angle of an azimuth thruster or a rudder.
- ``growing``: whole lines of a text that another program writes.
- ``quality``: held values, gaps, drop-outs and outliers are reported, and none is mended.
- ``reader``: all steps in order; ``record``: the log that they give; ``given``: a log by its path, checked, or as a table in memory.

The chapter may use ``files``, ``intervals`` and ``errors``. It knows no vehicle but the section ``[log]`` of its file.
"""

from ivsid.log.channels import COLUMNS
from ivsid.log.formats import TABLES, WHOLE, digest_of, open_source
from ivsid.log.given import GivenLog, log_of
from ivsid.log.parts import PARTS, Parts
from ivsid.log.reader import read_log
from ivsid.log.record import Clock, Log, Quality, StepRange
from ivsid.log.source import Source

__all__ = [
    "COLUMNS",
    "PARTS",
    "TABLES",
    "WHOLE",
    "Clock",
    "GivenLog",
    "Log",
    "Parts",
    "Quality",
    "Source",
    "StepRange",
    "digest_of",
    "log_of",
    "open_source",
    "read_log",
]
