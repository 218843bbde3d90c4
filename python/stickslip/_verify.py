"""Check that numbers are those that their scenario and their seed give."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from . import _native
from ._data import load, raw, ready, warn
from ._run import of_run
from ._seal import is_sealed
from .errors import VerificationError, wrong_argument

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Verified:
    """What was compared and found to be equal, bit for bit.

    Attributes:
        blocks: number of blocks of 256 paths in the run; 0 for a trade, a sweep or a calibration.
        blocks_checked: the numbers of the blocks that were simulated again.
        paths: number of paths in the run.
        paths_checked: number of paths that were simulated again.
        statistics_checked: whether all statistics were computed again and compared.
        values_checked: how many numbers and texts were compared.
        has_checksum: whether a file has a checksum, which then is right; None for a data set.
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
        blocks: how many blocks of 256 paths are simulated again; they are drawn at random in each
            call. "all" simulates the whole run again and compares all statistics, which takes as
            long as the run.
        threads: number of threads; one for each core if not given.

    Returns:
        What was compared. All of it is equal, bit for bit.

    Raises:
        VerificationError: a number differs from the one that the scenario gives. The error says
            which.
        RunError: the file is damaged: its checksum is wrong.
        ArgumentError: an argument is wrong, or is not a run.
        OSError: the file cannot be opened.
    """
    ready()
    if blocks != "all" and (isinstance(blocks, str) or blocks < 0):
        raise wrong_argument(
            "blocks", blocks, "it is no number of blocks", 'give a number of blocks, or "all"'
        )
    has_checksum = None
    where = "data set"
    if isinstance(run, (str, os.PathLike)):
        where, path = "file", Path(run)
        has_checksum = is_sealed(path)
        with load(path) as ds:
            if ds.attrs.get("format_name") in (
                "stick-slip trade",
                "stick-slip sweep",
                "stick-slip calibration",
            ):
                return Verified(0, (), 0, 0, False, 0, has_checksum, _is_same_program(ds))
            return _verified(ds.load(), blocks, threads, has_checksum, where)
    return _verified(run, blocks, threads, has_checksum, where)


def _verified(
    ds: xr.Dataset,
    blocks: int | Literal["all"],
    threads: int | None,
    has_checksum: bool | None,
    where: str,
) -> Verified:
    if not _is_same_program(ds):
        warn(
            [
                "it was made by another version of the program, "
                "which may compute other numbers"
            ],
            level=4,
        )
    of_run(ds)
    # Statistics of the caller's own cannot be computed again.
    own = [name for name in ds.variables if str(name).startswith("own")]
    wanted = None if blocks == "all" else int(blocks)
    count, again, paths, has_statistics, values, difference = _native.verify(
        raw(ds.drop_vars(own)), wanted, threads
    )
    if difference is not None:
        variable, path, index, stored, computed, place = difference
        problem = f"{place} is {stored} in the {where}, and {computed} when it is computed again"
        remedy = (
            f"take the {where} as it was made; "
            "its scenario, its seed or its numbers were changed since"
        )
        raise VerificationError(
            f"{problem}\n  fix: {remedy}",
            problem=problem,
            remedy=remedy,
            variable=variable,
            path=path,
            index=index,
            stored=stored,
            computed=computed,
        )
    return Verified(
        count,
        tuple(again),
        int(ds.attrs["completed_paths"]),
        paths,
        has_statistics,
        values,
        has_checksum,
        _is_same_program(ds),
    )


def _is_same_program(ds: xr.Dataset) -> bool:
    return (
        ds.attrs.get("program_version") == _native.VERSION
        and ds.attrs.get("git_hash") == _native.GIT_HASH
    )
