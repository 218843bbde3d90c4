"""Check a scenario without running it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from ._public import public
from ._scenario import ScenarioLike, Scheme, Settings, parse


@dataclass(frozen=True, repr=False)
class Check:
    """A checked scenario, as `mc check` prints it.

    Attributes:
        title: title of the scenario, in one line.
        toml: the whole scenario as TOML text, with every default written out. `run` accepts it as a
            scenario.
        derived: derived quantities by name, e.g. "natural_frequency" or "steps", in the units of
            the scenario; None for a quantity that does not exist.
        warnings: sentences by name; empty if there are no warnings.
    """

    title: str
    toml: str
    derived: dict[str, float | int | list[float] | None]
    warnings: dict[str, str]

    def __repr__(self) -> str:
        """The text of `mc check`."""
        derived = [f"# {name} = {text}" for name, text in self._derived()]
        warnings = [f"# warning: {text}" for text in self.warnings.values()]
        parts = [self.toml, "# Derived quantities", *derived, "", *(warnings or ["# no warnings"])]
        return "\n".join(parts)

    def _repr_html_(self) -> str:
        rows = "".join(f"<tr><td>{name}</td><td>{text}</td></tr>" for name, text in self._derived())
        warnings = [f"<li>{escape(text)}</li>" for text in self.warnings.values()]
        return (
            f"<h4>{escape(self.title)}</h4>"
            f"<ul>{''.join(warnings) or '<li>no warnings</li>'}</ul><table>{rows}</table>"
            f"<details><summary>scenario</summary><pre>{escape(self.toml)}</pre></details>"
        )

    def _derived(self) -> list[tuple[str, str]]:
        """The derived quantities that exist, as text."""
        known = [(name, value) for name, value in self.derived.items() if value is not None]
        lists = [(name, value if isinstance(value, list) else [value]) for name, value in known]
        return [(name, ", ".join(f"{x:.10g}" for x in numbers)) for name, numbers in lists]


@public
def check(
    scenario: ScenarioLike,
    *,
    paths: int | None = None,
    seed: int | None = None,
    scheme: Scheme | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    until: float | None = None,
    set: Settings | None = None,
    temperature: Any = None,
    inputs: Mapping[str, Any] | None = None,
) -> Check:
    """Check a scenario without running it, like `mc check`.

    Args:
        scenario, paths, seed, scheme, step, tolerance, until, set, temperature, inputs: as for
            `run`; `until` is a time.

    Returns:
        The resolved scenario, derived quantities, and warnings.

    Raises:
        ScenarioError: the scenario is invalid. The error gives the location and a fix.
        ArgumentError: `temperature` or one of `inputs` is not a measurement.
    """
    parsed = parse(locals())
    return Check(parsed.title, parsed.toml, parsed.derived(), dict(parsed.warnings()))
