"""Convert data sets between the engine and xarray."""

from __future__ import annotations

import os
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native
from ._public import public

if TYPE_CHECKING:
    import xarray as xr


def ready() -> None:
    """Import xarray, which takes most of a second, before the work begins.

    Otherwise it would be imported only when a result is returned, perhaps just after Ctrl-C.
    """
    import xarray  # noqa: F401


def dataset(
    made: tuple[dict[str, Any], list[tuple[str, tuple[str, ...], Any, dict[str, Any]]]],
) -> xr.Dataset:
    """The data set that `xarray.open_dataset` would read from a file with the same contents.

    The arrays keep the memory that the engine has filled; numbers are not copied.
    """
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
    """Attributes and variables of a data set in the form that the engine accepts."""
    variables = [
        (str(name), [str(axis) for axis in v.dims], v.to_numpy(), v.attrs)
        for name, v in ds.variables.items()
    ]
    return ds.attrs, variables


@public
def load(file: str | os.PathLike[str]) -> xr.Dataset:
    """Open a file that `mc run`, `merge`, `replay`, `sweep`, `trade` or `calibrate` wrote.

    Values are read from the file when they are used. xarray needs a netCDF-4 backend, such as
    h5netcdf, which the extra `files` of this package installs: `pip install './python[files]'`.

    Args:
        file: path of the file.

    Returns:
        The data set that `run`, `merge`, `replay`, `sweep`, `trade` or `calibrate` of this package
        returns. Close it, or use it in a `with` statement, before the file is replaced.

    Warns:
        StickSlipWarning: the file has no checksum, because another program changed it, or because
            an earlier version of mc wrote it.

    Raises:
        OSError: the file cannot be opened.
        ValueError: no netCDF-4 backend is installed, or the file is not a netCDF-4 file.
    """
    import xarray as xr

    path = Path(file)
    if path.is_file() and _native.checksum(str(path), False) is None:
        cause = "another program changed it, or an earlier version of mc wrote it"
        warn([f"{path} has no checksum: {cause}"])
    return xr.open_dataset(os.fspath(file), decode_times=False, decode_timedelta=False)


def warn(sentences: list[str], level: int = 4) -> None:
    """Issue a `StickSlipWarning` for each sentence, with `level` as its `stacklevel`."""
    from .errors import StickSlipWarning

    for sentence in sentences:
        warnings.warn(sentence, StickSlipWarning, stacklevel=level)
