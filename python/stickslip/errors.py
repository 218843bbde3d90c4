"""The exceptions of the package. Each states the problem and a fix."""

from __future__ import annotations

import reprlib
from collections.abc import Mapping
from numbers import Real
from typing import Any

__all__ = [
    "ArgumentError",
    "RunError",
    "ScenarioError",
    "StickSlipError",
    "StickSlipWarning",
    "VerificationError",
]


class StickSlipError(Exception):
    """The base class of all errors of this package.

    Attributes:
        problem: what is wrong.
        remedy: how to fix it.
    """

    problem: str = ""
    remedy: str = ""

    def __init__(self, message: str, **attributes: Any) -> None:
        super().__init__(message)
        for name, value in attributes.items():
            setattr(self, name, value)


class ScenarioError(StickSlipError, ValueError):
    """A scenario cannot be read, or one of its values is invalid.

    If there are several errors, the message lists them all; the attributes describe the first.

    Attributes:
        origin: the file, or the argument with its value.
        line: line in the text, from 1; None for an argument.
        column: column in the text, from 1; None for an argument.
        key: the dotted key of the invalid value, if there is one.
        value: the value as it was written, if there is one.
        excerpt: the line, with a caret under the place.
    """

    origin: str = ""
    line: int | None = None
    column: int | None = None
    key: str | None = None
    value: str | None = None
    excerpt: str | None = None


class ArgumentError(StickSlipError, ValueError):
    """An argument of a function is unknown or invalid.

    Attributes:
        argument: the name of the argument.
        value: its value, as text.
    """

    argument: str = ""
    value: str = ""


class RunError(StickSlipError, RuntimeError):
    """A run, a trade, a calibration or a forecast has no result."""


class VerificationError(RunError):
    """A number differs from the one that the scenario and the seed give.

    Attributes:
        variable: the name of the variable or attribute.
        path: number of the path; None if the number does not belong to a single path.
        index: index of the value, from 0: among the values of the path, or in the whole variable.
        stored: the value in the data set or file, as text.
        computed: the value that the second simulation gives, as text.
    """

    variable: str = ""
    path: int | None = None
    index: int | None = None
    stored: str = ""
    computed: str = ""


class StickSlipWarning(UserWarning):
    """A result should be used with care, for the stated reason."""


def wrong_argument(argument: str, value: object, problem: str, remedy: str) -> ArgumentError:
    """The exception for an invalid argument."""
    message = f"{argument} = {value}: {problem}\n  fix: {remedy}"
    return ArgumentError(
        message, argument=argument, value=str(value), problem=problem, remedy=remedy
    )


def require(is_right: bool, argument: str, value: object, problem: str, remedy: str) -> None:
    """Raise the exception for an invalid argument unless it is right."""
    if not is_right:
        raise wrong_argument(argument, value, problem, remedy)


def mappings(example: str, **arguments: object) -> None:
    """Raise the exception for an argument that is given but no dictionary like this example."""
    for name, value in arguments.items():
        is_right = value is None or isinstance(value, Mapping)
        remedy = f"give a dictionary, e.g. {example}"
        require(is_right, name, reprlib.repr(value), "it is not a dictionary", remedy)


def within(low: float, high: float, **arguments: float) -> None:
    """Raise the exception for an argument that is not between these bounds."""
    for name, value in arguments.items():
        remedy = f"must be between {low:g} and {high:g}"
        is_right = isinstance(value, Real) and low <= value <= high
        require(is_right, name, value, "wrong type or out of range", remedy)
