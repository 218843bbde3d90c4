"""Data sets of the engine as xarray data sets."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import xarray as xr


def ready() -> None:
    """Import xarray, which takes most of a second: better before a run than after Ctrl-C has ended it."""
    import xarray  # noqa: F401


def dataset(made: tuple[dict[str, Any], list[tuple[str, tuple[str, ...], Any, dict[str, Any]]]]) -> xr.Dataset:
    """What `xarray.open_dataset` makes of a file of the same. The arrays keep the memory that the engine filled."""
    import xarray as xr

    attributes, variables = made
    coordinates: set[str] = set()
    held = {}
    for name, axes, values, own in variables:
        named = own.pop("coordinates", None)
        variable = xr.Variable(axes, values, own, fastpath=True)
        if named is not None:
            coordinates.update(named.split())
            variable.encoding["coordinates"] = named
        if values.dtype.kind == "f" and axes != (name,):
            variable.encoding["_FillValue"] = float("nan")
        held[name] = variable
    return xr.Dataset(held, attrs=attributes).set_coords(coordinates & set(held))


def raw(ds: xr.Dataset) -> tuple[dict[str, Any], list[tuple[str, list[str], Any, dict[str, Any]]]]:
    """The same as the engine takes it back."""
    variables = [(str(name), [str(axis) for axis in v.dims], v.to_numpy(), v.attrs) for name, v in ds.variables.items()]
    return ds.attrs, variables


def load(file: str | os.PathLike[str]) -> xr.Dataset:
    """Open a file of `mc run`, `mc replay`, `mc sweep`, `mc trade` or `mc calibrate`.

    It is the data set that the function of the same name returns; values are read when they are used. It takes one of
    the readers of netCDF-4 that xarray knows: `pip install stickslip[files]` brings h5netcdf.

    Raises:
        OSError: the file cannot be opened.
    """
    import xarray as xr

    return xr.open_dataset(os.fspath(file), decode_times=False, decode_timedelta=False)


def warn(sentences: list[str], level: int = 3) -> None:
    """Say in what way a result is not what it seems to be."""
    from .errors import StickSlipWarning

    for sentence in sentences:
        warnings.warn(sentence, StickSlipWarning, stacklevel=level)
