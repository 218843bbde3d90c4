"""Pictures that a notebook shows."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from . import _native
from ._data import raw
from ._run import of_run
from ._scenario import ScenarioLike, Settings, parse
from .errors import wrong_argument

if TYPE_CHECKING:
    import xarray as xr

#: Millimetres of a figure that is one column of a journal wide.
COLUMN = 86.0


class Picture:
    """A picture. A notebook shows it as SVG; `save` writes SVG, PNG or PDF."""

    def __init__(self, scene: _native.Picture) -> None:
        self._scene = scene

    @property
    def svg(self) -> str:
        """The picture as SVG text."""
        return self._scene.svg

    def png(self, dots_per_inch: float = 300.0) -> bytes:
        """The picture as PNG."""
        return self._scene.png(dots_per_inch)

    def pdf(self) -> bytes:
        """The picture as PDF."""
        return self._scene.pdf()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the picture; the ending of the name, .svg, .png or .pdf, tells the format.

        Raises:
            ArgumentError: the ending tells none.
        """
        path = Path(file)
        made = {".svg": lambda: self.svg.encode(), ".png": self.png, ".pdf": self.pdf}.get(path.suffix.lower())
        if made is None:
            raise wrong_argument("file", path, "the ending does not tell a format", "end it in .svg, .png or .pdf")
        path.write_bytes(made())

    def _repr_svg_(self) -> str:
        return self.svg


def plot(
    subject: Union[ScenarioLike, xr.Dataset, Mapping[str, xr.Dataset]],
    *,
    only: str | None = None,
    path: int = 0,
    until: float | None = None,
    statistic: str | None = None,
    theme: str = "light",
    width: float = COLUMN,
    log: bool = False,
    set: Settings | None = None,
) -> Picture:
    """Draw a scenario's path, a run, a trade, sweeps or a calibration, like `mc plot`.

    Args:
        subject: a scenario as for `run`; a data set of `run`, `trade`, `sweep` or `calibrate`, or `load` of a file; or several sweeps
            over one key, by name.
        only: one figure: path, fan, sticks, sub-phases, drift, trade, sweep, tornado, calibration, loops or residuals.
        path: number of the path that is drawn.
        until: draw the path of a scenario up to this time only.
        statistic: the statistic of a trade or a sweep.
        theme: "light" or "dark".
        width: width of one figure in millimetres; a page is two figures wide.
        log: logarithmic vertical axes for densities and shares.
        set: dotted keys with values, of a scenario.

    Raises:
        ArgumentError: there is no such figure of the subject.
        ScenarioError: something in the scenario is wrong.
    """
    if theme not in ("light", "dark"):
        raise wrong_argument("theme", theme, "there is no such theme", "write light or dark")
    drawn = (only, theme == "dark", float(width), log)
    given: Any = subject
    if not _is_data(given):
        if isinstance(given, Mapping) and all(map(_is_data, given.values())):
            sweeps = [(str(name), raw(sweep)) for name, sweep in given.items()]
            return Picture(_native.plot_sweeps(sweeps, statistic, drawn))
        parsed = parse(given, set, until=until)
        return Picture(_native.plot_scenario(parsed, None, path, drawn))
    ds: xr.Dataset = given
    kind = ds.attrs.get("format_name")
    if kind == "stick-slip trade":
        return Picture(_native.plot_trade(raw(ds), statistic, drawn))
    if kind == "stick-slip sweep":
        return Picture(_native.plot_sweeps([("sweep", raw(ds))], statistic, drawn))
    if kind == "stick-slip calibration":
        return Picture(_native.plot_calibration(raw(ds), drawn))
    return Picture(_native.plot_scenario(of_run(ds), raw(ds), path, drawn))


def _is_data(subject: object) -> bool:
    return hasattr(subject, "data_vars")
