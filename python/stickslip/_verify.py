"""Check that numbers are those that their scenario and their seed give."""

from __future__ import annotations

import os
import random
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from . import _native
from ._data import dataset, load, ready, warn
from ._run import of_run
from ._seal import is_sealed
from .errors import RunError, VerificationError, wrong_argument

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import xarray as xr

#: Attributes that another program writes otherwise although every number is the same.
_OF_PROGRAM = {"Conventions", "format_version", "program_version", "git_hash", "scenario"}

#: Attributes that say how a run ended, which are compared with each other.
_OF_END = {"status", "completed_paths", "paths", "ended_by", "part"}

#: Dimensions of what is kept of single paths.
_ROWS = ("path", "event", "trajectory")


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
    scenario = of_run(ds)
    size, completed, paths = (
        int(ds.attrs[name]) for name in ("block_size", "completed_paths", "paths")
    )
    part = ds.attrs.get("part")
    first = _first_block(-(-paths // size), part)
    there = range(first, first + -(-completed // size))
    has_rows = any(axis in ds.sizes for axis in _ROWS)
    is_whole = blocks == "all" or blocks >= len(there)
    again: list[int] = (
        list(there) if is_whole else sorted(random.sample(there, int(blocks))) if has_rows else []
    )
    compared = _Compared(where, first * size)
    _compare_end(compared, ds, size, first)
    if is_whole:
        # A run that a goal or Ctrl-C has ended equals a run of the paths that it completed.
        whole = of_run(ds, paths if part else completed)
        has_bias = bool(ds["bias"].notnull().any())
        made, _, _, _ = _native.run(
            whole,
            goals=[],
            is_bounded=True,
            max_time=None,
            part=part,
            bias=has_bias,
            threads=threads,
            progress=None,
            own=[],
        )
        computed = dataset(made)
        surplus = {str(name) for name in ds.variables} - {str(name) for name in computed.variables}
        surplus = {
            name
            for name in surplus
            if not name.startswith("own") and name not in ("part_sums", "part_state")
        }
        for name in sorted(surplus):
            compared.differ(name, None, None, "there", "missing")
        names = [str(name) for name in computed.variables]
    else:
        computed = dataset(_native.blocks(scenario, paths, again, threads))
        names = [
            str(name)
            for name in computed.variables
            if name in ds.variables or computed[name].dims[:1] not in [(a,) for a in _ROWS]
        ]
    rows = _rows(
        ds,
        [range(n * size, min((n + 1) * size, first * size + completed)) for n in again],
        first * size,
    )
    # A run that ended early has the scenario of the whole run.
    is_own = _is_same_program(ds) and ds.attrs["status"] in ("complete", "part")
    left_out = _OF_END | (set() if is_own else _OF_PROGRAM)
    if not is_whole:
        left_out |= {"diverged_paths"}
    for name in names:
        if name in ds.variables:
            compared.attributes(f" of {name}", ds[name].attrs, computed[name].attrs)
        axis = str(computed[name].dims[0]) if computed[name].dims else ""
        compared.variable(name, ds.get(name), computed[name], rows.get(axis), ds.get("event_count"))
    compared.attributes("", ds.attrs, computed.attrs, left_out)
    again_paths = sum(min((n + 1) * size, first * size + completed) - n * size for n in again)
    return Verified(
        len(there),
        tuple(again),
        completed,
        again_paths,
        is_whole,
        compared.values,
        has_checksum,
        _is_same_program(ds),
    )


def _compare_end(compared: _Compared, ds: xr.Dataset, size: int, first: int) -> None:
    """Compare how the run ended and its number of paths with what was asked for."""
    paths, completed = int(ds.attrs["paths"]), int(ds.attrs["completed_paths"])
    part = ds.attrs.get("part")
    end = _first_block(-(-paths // size), part, 0) * size
    own = min(paths, end) - first * size
    status = "part" if part else "complete"
    if "ended_by" in ds.attrs or ds.attrs["status"] == "interrupted":
        # It ended after a block that is not the last.
        status = "ended" if "ended_by" in ds.attrs else "interrupted"
        own = min(own, completed) // size * size
    compared.attribute("status", ds.attrs["status"], status)
    compared.attribute("completed_paths", completed, own)
    if "path" in ds.sizes:
        compared.attribute("number of rows along path", ds.sizes["path"], own)


def _is_same_program(ds: xr.Dataset) -> bool:
    return (
        ds.attrs.get("program_version") == _native.VERSION
        and ds.attrs.get("git_hash") == _native.GIT_HASH
    )


def _first_block(blocks: int, part: str | None, before: int = 1) -> int:
    """The first block of a part such as "3/16"; with `before` = 0 the first one after it."""
    number, count = map(int, (part or "1/1").split("/"))
    return blocks * (number - before) // count


def _rows(ds: xr.Dataset, ranges: list[range], origin: int) -> dict[str, npt.NDArray[np.intp]]:
    """For each dimension of single paths, the indices of the rows of these paths."""
    import numpy as np

    wanted = np.concatenate([np.arange(r.start, r.stop) for r in ranges] or [np.arange(0)]) - origin
    rows = {"path": wanted, "trajectory": wanted[wanted < ds.sizes.get("trajectory", 0)]}
    if "event_count" in ds:
        count = ds.event_count.to_numpy().astype(np.intp)
        ends = np.cumsum(count)
        some = [np.arange(ends[path] - count[path], ends[path]) for path in wanted]
        rows["event"] = np.concatenate(some or [np.arange(0)])
    return rows


class _Compared:
    """Compares values, counts them, and raises `VerificationError` at the first difference."""

    def __init__(self, where: str, origin: int) -> None:
        self.where, self.origin, self.values = where, origin, 0

    def differ(
        self, variable: str, path: int | None, index: int | None, stored: object, computed: object
    ) -> None:
        place = variable if path is None else f"path {path}: {variable}"
        if path is not None and index:
            place = f"{place}, value {index} of the path,"
        elif path is None and index is not None:
            place = f"{place}, value {index},"
        problem = (
            f"{place} is {stored} in the {self.where}, and {computed} when it is computed again"
        )
        remedy = (
            f"take the {self.where} as it was made; "
            "its scenario, its seed or its numbers were changed since"
        )
        raise VerificationError(
            f"{problem}\n  fix: {remedy}",
            problem=problem,
            remedy=remedy,
            variable=variable,
            path=path,
            index=index,
            stored=str(stored),
            computed=str(computed),
        )

    def attribute(self, name: str, stored: object, computed: object) -> None:
        import numpy as np

        self.values += 1
        is_same = stored is not None and computed is not None
        if not is_same or not np.array_equal(np.asarray(stored), np.asarray(computed)):
            shown = ["missing" if value is None else value for value in (stored, computed)]
            # Of texts of several lines, such as a scenario, the first lines that differ are shown.
            lines = zip(*(str(value).splitlines() for value in shown), strict=False)
            self.differ(name, None, None, *next((x for x in lines if x[0] != x[1]), shown))

    def attributes(
        self,
        where: str,
        stored: Mapping[Any, object],
        computed: Mapping[Any, object],
        left_out: set[str] | None = None,
    ) -> None:
        """Compare all attributes of a data set or of a variable; `where` follows their names."""
        for name in sorted({*stored, *computed} - (left_out or set())):
            self.attribute(f"{name}{where}", stored.get(name), computed.get(name))

    def variable(
        self,
        name: str,
        stored: xr.DataArray | None,
        computed: xr.DataArray,
        rows: npt.NDArray[np.intp] | None,
        counts: xr.DataArray | None,
    ) -> None:
        import numpy as np

        right = computed.to_numpy()
        self.values += right.size
        if stored is None:
            return self.differ(name, None, None, "missing", "there") if right.size else None
        left = stored.to_numpy()
        if rows is not None:
            left = left[rows[rows < len(left)]]
        if left.shape != right.shape:
            sizes = f"one of {left.size} values", f"one of {right.size}"
            return self.differ(name, None, None, *sizes)
        same = left == right
        if right.dtype.kind == "f":
            same = (left.view(np.uint64) == right.view(np.uint64)) | (
                np.isnan(left) & np.isnan(right)
            )
        if same.all():
            return None
        at = tuple(int(i) for i in np.argwhere(~same)[0])
        index = int(np.ravel_multi_index(at, right.shape))
        stored_value, computed_value = left[at], right[at]
        shown = [
            repr(value.item() if hasattr(value, "item") else value)
            for value in (stored_value, computed_value)
        ]
        if rows is None:
            return self.differ(name, None, index, *shown)
        row, path = int(rows[at[0]]), int(rows[at[0]])
        index -= at[0] * (right.size // len(right))
        if computed.dims[0] == "event" and counts is not None:
            ends = np.cumsum(counts.to_numpy().astype(np.intp))
            path = int(np.searchsorted(ends, row, side="right"))
            index = row - int(ends[path] - counts.to_numpy()[path])
        return self.differ(name, self.origin + path, index, *shown)
