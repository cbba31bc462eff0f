"""The optional packages of a fleet, loaded when they are needed."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType

from ivsid.errors import IvsidError


def distributed() -> ModuleType:
    """The package ``distributed`` of Dask.

    Raises:
        IvsidError: it is not installed.
    """
    return _loaded("distributed", "several processes or a cluster need")


def dask() -> ModuleType:
    """The package ``dask``, which comes with ``distributed``.

    Raises:
        IvsidError: it is not installed.
    """
    return _loaded("dask", "several processes or a cluster need")


def fsspec() -> ModuleType:
    """The package ``fsspec``.

    Raises:
        IvsidError: it is not installed.
    """
    return _loaded("fsspec", "logs and results behind URLs need")


def _loaded(name: str, use: str) -> ModuleType:
    try:
        return import_module(name)
    except ImportError:
        raise IvsidError(f"{use} the package {name}, which is not installed: pip install 'ivsid[fleet]'") from None
