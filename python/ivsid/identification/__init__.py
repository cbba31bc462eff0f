"""Method by name -> parameter intervals with their status and assumptions."""

from ivsid.identification.fit import Identification, Parameter, read_identification
from ivsid.identification.freedom import in_words
from ivsid.identification.method import METHODS, identify, identify_rows

__all__ = ["METHODS", "Identification", "Parameter", "identify", "identify_rows", "in_words", "read_identification"]
