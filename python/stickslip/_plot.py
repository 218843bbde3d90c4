"""Pictures, which a notebook shows."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Union

from . import _native
from ._data import raw
from ._public import public
from ._run import STUDIES, of_run
from ._scenario import ScenarioLike, Settings, parse
from .errors import mappings, require, wrong_argument

if TYPE_CHECKING:
    import xarray as xr

#: Default width of a figure in millimetres: one column of a journal.
_COLUMN = 86.0


@dataclass(frozen=True)
class _Pickled:
    """The contents of the files of a picture."""

    svg: str
    png_300: bytes
    pdf_file: bytes

    def png(self, dots_per_inch: float) -> bytes:
        problem, remedy = "the picture was pickled", "use 300, or draw it again"
        require(dots_per_inch == 300, "dots_per_inch", dots_per_inch, problem, remedy)
        return self.png_300

    def pdf(self) -> bytes:
        return self.pdf_file


class Picture:
    """A picture. A notebook shows it as SVG; `save` writes it as SVG, PNG or PDF.

    It can be pickled. The PNG of an unpickled picture has 300 dots per inch.
    """

    def __init__(self, scene: _native.Picture) -> None:
        self._scene: _native.Picture | _Pickled = scene

    def __getstate__(self) -> dict[str, Any]:
        return {"_scene": _Pickled(self.svg, self.png(), self.pdf())}

    @property
    def svg(self) -> str:
        """The picture as the text of an SVG file."""
        return self._scene.svg

    def png(self, dots_per_inch: float = 300.0) -> bytes:
        """The picture as the bytes of a PNG file.

        Args:
            dots_per_inch: resolution; 300 suits print.

        Raises:
            RunError: the picture would have more than 10^8 pixels.
        """
        return self._scene.png(dots_per_inch)

    def pdf(self) -> bytes:
        """The picture as the bytes of a PDF file."""
        return self._scene.pdf()

    def save(self, file: str | os.PathLike[str]) -> None:
        """Write the picture to a file, which is replaced if it exists.

        Args:
            file: name of the file. Its extension, .svg, .png or .pdf, selects the format.

        Raises:
            ArgumentError: the file extension is unknown.
            OSError: the file cannot be written.
        """
        path = Path(file)
        made = {".svg": lambda: self.svg.encode(), ".png": self.png, ".pdf": self.pdf}.get(
            path.suffix.lower()
        )
        if made is None:
            raise wrong_argument(
                "file", path, "unknown file extension", "use .svg, .png or .pdf"
            )
        path.write_bytes(made())

    def _repr_svg_(self) -> str:
        return self.svg


@public
def plot(
    subject: Union[ScenarioLike, xr.Dataset, Mapping[str, xr.Dataset]],
    *,
    only: str | None = None,
    path: int = 0,
    until: float | None = None,
    statistic: str | None = None,
    theme: str = "light",
    width: float = _COLUMN,
    log: bool = False,
    title: str | None = None,
    labels: Mapping[str, str] | None = None,
    set: Settings | None = None,
) -> Picture:
    """Draw a path of a scenario, a run, a trade, sweeps or a calibration, like `mc plot`.

    Without `only`, the picture is a page with a heading and all figures of the subject except
    `overview` and `section`.

    Args:
        subject: a scenario as for `run`, of which one path is drawn; a data set that `run`,
            `merge`, `trade`, `sweep` or `calibrate` returned, or `load` of a file of them; or
            several data sets of sweeps over the same key, as a dictionary by name.
        only: the name of one figure, or of one of its panels by its letter, e.g. "sticks.B". Of a
            scenario: "path". Of a run: "overview", "path", "fan", "sticks", "sub-phases",
            "passages" or "drift", and "laws", "density" or "spectrum" if recorded. Of a trade: "trade". Of
            sweeps: "sweep", "section" for deterministic scenarios, or "tornado" for elasticities.
            Of a calibration: "calibration", "loops" or "residuals".
        path: number of the path that is drawn, from 0, of a scenario or a run.
        until: time at which the path of a scenario ends, in its unit of time. It has no effect on a
            data set.
        statistic: the name of the statistic to draw of a trade or of sweeps; by default, the first
            statistic of a trade that has an estimate, or two statistics of sweeps.
        theme: "light" or "dark".
        width: width of one figure in millimetres, from 60 to 400; a page is two figures wide.
        log: whether densities and fractions have logarithmic vertical axes.
        title: the heading of a page; by default that of the subject.
        labels: labels of keys and statistics on the axes of sweeps, by name.
        set: further keys of a scenario with their values, as for `run`. It has no effect on a data
            set.

    Returns:
        The picture.

    Raises:
        ArgumentError: the subject has no such figure, or an argument is invalid.
        ScenarioError: the scenario is invalid.
        RunError: there is nothing to draw, because every path was lost.
    """
    mappings('{"rho": "weight of the noise"}', labels=labels)
    is_known = theme in ("light", "dark")
    require(is_known, "theme", theme, "unknown theme", "write light or dark")
    drawn = (only, theme == "dark", float(width), log, title, [*(labels or {}).items()])
    given: Any = subject
    data: Mapping[str, Any] = {"sweep": given}
    scenario = None
    if not _is_data(given):
        data = given if isinstance(given, Mapping) and all(map(_is_data, given.values())) else {}
        scenario = None if data else parse({"scenario": given, "set": set, "until": until})
    elif _kind(given) not in STUDIES:
        scenario = of_run(given)
    is_sweep = scenario is None and {*map(_kind, data.values())} == {"stick-slip sweep"}
    require(is_sweep or not labels, "labels", labels, "the subject is not a sweep", "remove it")
    handed = [(str(name), raw(one)) for name, one in data.items()]
    return Picture(_native.plot(scenario, handed, path, statistic, drawn))


def _kind(data: Any) -> Any:
    return data.attrs.get("format_name")


def _is_data(subject: object) -> bool:
    return hasattr(subject, "data_vars")
