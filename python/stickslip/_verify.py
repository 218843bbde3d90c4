"""Check that results are reproducible from their scenario and seed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from . import _native
from ._data import load, raw, ready, warn
from ._progress import Progress, shown
from ._public import public
from ._run import STUDIES, of_run
from .errors import RunError, VerificationError, require

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Verified:
    """What was compared and found identical, bit for bit.

    Attributes:
        paths: number of paths that were simulated again; 0 for a trade, a sweep or a calibration.
        values_checked: number of numbers and strings compared.
        has_checksum: whether a file has a checksum, which is then correct; None for a data set.
        same_program: whether this version of the program made the run.
    """

    paths: int
    values_checked: int
    has_checksum: bool | None
    same_program: bool


@public
def verify(
    run: xr.Dataset | str | os.PathLike[str],
    *,
    threads: int | None = None,
    progress: Progress = True,
) -> Verified:
    """Compare a run with a second simulation of its scenario and seed, and a file with its
    checksum, like `mc verify --again`. This takes as long as the run.

    Args:
        run: a data set that `run`, `merge` or `load` returned, or the path of the file of a run.
            The path may also be the file of a trade, a sweep or a calibration, of which only the
            checksum is compared; `mc verify --again` compares these as well.
        threads, progress: as for `run`.

    Returns:
        What was compared. All of it is identical, bit for bit.

    Raises:
        VerificationError: a number differs from the one that the scenario gives. The error
            names it.
        RunError: the file is damaged: its checksum is wrong.
        ArgumentError: an argument is invalid, is not a run, or is a part of one.
        OSError: the file cannot be opened.
    """
    ready()
    if not isinstance(run, (str, os.PathLike)):
        return _verified(run, threads, progress, None, "data set")
    path = Path(run)
    path.stat()
    is_right = _native.checksum(str(path), True)
    if is_right is False:
        problem = f"{path} is damaged: its checksum does not match"
        remedy = "restore it from a copy, or run its scenario again"
        raise RunError(f"{problem}\n  fix: {remedy}", problem=problem, remedy=remedy)
    has_checksum = is_right is not None
    with load(path) as ds:
        if ds.attrs.get("format_name") in STUDIES:
            return Verified(0, 0, has_checksum, _is_same_program(ds))
        return _verified(ds.load(), threads, progress, has_checksum, "file")


def _verified(
    ds: xr.Dataset,
    threads: int | None,
    progress: Progress,
    has_checksum: bool | None,
    where: str,
) -> Verified:
    is_same = _is_same_program(ds)
    other = "it was made by another version of the program, whose results may differ"
    warn([] if is_same else [other], level=5)
    of_run(ds)
    part = ds.attrs.get("part")
    remedy = "merge the parts and verify the run"
    require(part is None, "run", f"part {part}", "a part cannot be simulated again", remedy)
    # User-defined statistics cannot be computed again.
    own = [name for name in ds.variables if str(name).startswith("own")]
    with shown(progress) as callback:
        values, difference = _native.verify(raw(ds.drop_vars(own)), threads, callback)
    if difference is not None:
        problem = (
            f"{difference.pop('place')} is {difference['stored']} in the {where}, "
            f"but {difference['computed']} when computed again"
        )
        remedy = (
            f"use the unmodified {where}; "
            "its scenario, seed or numbers were changed"
        )
        message = f"{problem}\n  fix: {remedy}"
        raise VerificationError(message, problem=problem, remedy=remedy, **difference)
    completed = int(ds.attrs["completed_paths"])
    return Verified(completed, values, has_checksum, is_same)


def _is_same_program(ds: xr.Dataset) -> bool:
    return (
        ds.attrs.get("program_version") == _native.VERSION
        and ds.attrs.get("git_hash") == _native.GIT_HASH
    )
