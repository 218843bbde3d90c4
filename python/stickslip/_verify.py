"""Check that results are reproducible from their scenario and seed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from . import _native
from ._data import load, raw, ready, warn
from ._run import STUDIES, of_run
from .errors import RunError, VerificationError, require

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Verified:
    """What was compared and found identical, bit for bit.

    Attributes:
        blocks: number of blocks of 256 paths in the run; 0 for a trade, a sweep or a calibration.
        blocks_checked: the numbers of the blocks that were simulated again.
        paths: number of paths in the run.
        paths_checked: number of paths that were simulated again.
        statistics_checked: whether all statistics were computed again and compared.
        values_checked: number of numbers and strings compared.
        has_checksum: whether a file has a checksum, which is then correct; None for a data set.
        same_program: whether this version of the program made the run.
    """

    blocks: int
    blocks_checked: tuple[int, ...]
    paths: int
    paths_checked: int
    statistics_checked: bool
    values_checked: int
    has_checksum: bool | None
    same_program: bool


def verify(
    run: xr.Dataset | str | os.PathLike[str],
    *,
    blocks: int | Literal["all"] = 8,
    threads: int | None = None,
) -> Verified:
    """Compare a run with a second simulation of its scenario and seed, and a file with its
    checksum, like `mc verify`.

    Args:
        run: a data set that `run`, `merge` or `load` returned, or the path of the file of a run.
            The path may also be the file of a trade, a sweep or a calibration, of which only the
            checksum is compared; `mc verify` compares these as well.
        blocks: number of blocks of 256 paths to simulate again, drawn at random in each
            call. "all" simulates the whole run again and compares all statistics, which takes as
            long as the run.
        threads: number of threads; one for each core if not given.

    Returns:
        What was compared. All of it is identical, bit for bit.

    Raises:
        VerificationError: a number differs from the one that the scenario gives. The error
            names it.
        RunError: the file is damaged: its checksum is wrong.
        ArgumentError: an argument is invalid, or is not a run.
        OSError: the file cannot be opened.
    """
    ready()
    is_number = blocks == "all" or not isinstance(blocks, str) and blocks >= 0
    remedy = 'give a number of blocks, or "all"'
    require(is_number, "blocks", blocks, "it is not a number of blocks", remedy)
    if not isinstance(run, (str, os.PathLike)):
        return _verified(run, blocks, threads, None, "data set")
    path = Path(run)
    path.stat()
    is_right = _native.sealed(str(path), True)
    if is_right is False:
        problem = f"{path} is damaged: its checksum does not match"
        remedy = "restore it from a copy, or run its scenario again"
        raise RunError(f"{problem}\n  fix: {remedy}", problem=problem, remedy=remedy)
    has_checksum = is_right is not None
    with load(path) as ds:
        if ds.attrs.get("format_name") in STUDIES:
            return Verified(0, (), 0, 0, False, 0, has_checksum, _is_same_program(ds))
        return _verified(ds.load(), blocks, threads, has_checksum, "file")


def _verified(
    ds: xr.Dataset,
    blocks: int | Literal["all"],
    threads: int | None,
    has_checksum: bool | None,
    where: str,
) -> Verified:
    is_same = _is_same_program(ds)
    other = "it was made by another version of the program, whose results may differ"
    warn([] if is_same else [other], level=4)
    of_run(ds)
    # Statistics of the caller's own cannot be computed again.
    own = [name for name in ds.variables if str(name).startswith("own")]
    wanted = None if blocks == "all" else int(blocks)
    found, difference = _native.verify(raw(ds.drop_vars(own)), wanted, threads)
    if difference is not None:
        problem = (
            f"{difference.pop('place')} is {difference['stored']} in the {where}, "
            f"but {difference['computed']} when computed again"
        )
        remedy = (
            f"use the unmodified {where};  "
            "its scenario, seed or numbers were changed"
        )
        message = f"{problem}\n  fix: {remedy}"
        raise VerificationError(message, problem=problem, remedy=remedy, **difference)
    completed = int(ds.attrs["completed_paths"])
    return Verified(paths=completed, has_checksum=has_checksum, same_program=is_same, **found)


def _is_same_program(ds: xr.Dataset) -> bool:
    return (
        ds.attrs.get("program_version") == _native.VERSION
        and ds.attrs.get("git_hash") == _native.GIT_HASH
    )
