"""Check a scenario without running it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._scenario import ScenarioLike, Scheme, Settings, parse
from ._types import checked
from ._wording import in_python


@dataclass(frozen=True)
class Check:
    """A checked scenario, as `mc check` prints it.

    Attributes:
        title: what the scenario asks, in one line.
        toml: the whole scenario as TOML text, with every default written out. `run` accepts it as a
            scenario.
        derived: numbers that follow from the scenario, by name, e.g. "natural_frequency" or
            "steps". They are in the units of the scenario, and None where there is no such number.
        warnings: sentences by name; empty if there is nothing to warn about.
    """

    title: str
    toml: str
    derived: dict[str, float | int | list[float] | None]
    warnings: dict[str, str]


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
) -> Check:
    """Check a scenario without running it, like `mc check`.

    Args:
        scenario: the path of a TOML file, TOML text of several lines, the name of a shipped
            scenario such as "rho025", or a dictionary of tables.
        paths: number of paths [ensemble.paths].
        seed: seed of all random numbers [ensemble.seed].
        scheme: "discrete-vi", "corrected-vi", "event-driven" or "quasi-static" [scheme.kind].
        step: time step of "discrete-vi" and "corrected-vi", in the unit of time of the scenario
            [time.step].
        tolerance: relative error that the discretisation of "event-driven" and "quasi-static" may
            leave [scheme.tolerance].
        until: the time at which each path ends, in the unit of time of the scenario [time.end].
        set: further keys with their values, as for `run`.
        temperature: a measured temperature, as for `run`.

    Returns:
        The scenario in full, the numbers that follow from it, and warnings.

    Raises:
        ScenarioError: something in the scenario is wrong. The error says where, and what would be
            right.
        ArgumentError: `temperature` is not a measurement.
    """
    checked(check, locals())
    parsed = parse(
        scenario,
        set,
        temperature,
        paths=paths,
        seed=seed,
        scheme=scheme,
        step=step,
        tolerance=tolerance,
        until=until,
    )
    warnings = {name: in_python(sentence) for name, sentence in parsed.warnings()}
    return Check(parsed.title, parsed.toml, parsed.derived(), warnings)
