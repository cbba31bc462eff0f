"""Method by name -> parameter intervals with their status and assumptions."""

from ivsid.identification.fit import Identification, Parameter, read_identification
from ivsid.identification.method import METHODS, identify, identify_rows

__all__ = ["METHODS", "Identification", "Parameter", "identify", "identify_rows", "read_identification"]
