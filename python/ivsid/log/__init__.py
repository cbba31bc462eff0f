"""Logs: files of many kinds to checked channels in SI units and the contract's axes (INTERFACE.md).

One file a format (``text``, ``matlab``, ``rosbag``, ``dataflash``; ``formats`` tells them apart), and one a step:
``channels`` maps and turns, ``clocks`` and ``one_clock`` bring to one clock, ``sweep`` keeps what stands between rows, ``quality`` examines, ``reader`` calls them in order.
"""

from ivsid.log.channels import COLUMNS
from ivsid.log.formats import open_source
from ivsid.log.reader import read_log
from ivsid.log.record import Clock, Log, Quality, Sweep
from ivsid.log.source import Source

__all__ = ["COLUMNS", "Clock", "Log", "Quality", "Source", "Sweep", "open_source", "read_log"]
