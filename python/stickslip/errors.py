"""What can go wrong, as exceptions that say what to change."""

from __future__ import annotations

__all__ = ["ArgumentError", "RunError", "ScenarioError", "StickSlipError", "StickSlipWarning", "VerificationError"]


class StickSlipError(Exception):
    """Any error of this package. Its text is the message that the command prints.

    Attributes:
        problem: what is wrong.
        remedy: what would be right.
    """

    problem: str
    remedy: str

    def __init__(self, message: str, *, problem: str = "", remedy: str = "") -> None:
        super().__init__(message)
        self.problem = problem
        self.remedy = remedy


class ScenarioError(StickSlipError, ValueError):
    """A scenario cannot be read, or something in it or in an override is wrong.

    Attributes:
        origin: the file, or the override.
        line: line in the text, from 1; an override has none.
        column: column in the text, from 1.
        key: the dotted key, if it is about one.
        value: the value as written, if there is one.
        excerpt: the line with a caret under the place.
    """

    def __init__(
        self,
        message: str,
        *,
        origin: str = "",
        line: int | None = None,
        column: int | None = None,
        key: str | None = None,
        value: str | None = None,
        problem: str = "",
        remedy: str = "",
        excerpt: str | None = None,
    ) -> None:
        super().__init__(message, problem=problem, remedy=remedy)
        self.origin = origin
        self.line = line
        self.column = column
        self.key = key
        self.value = value
        self.excerpt = excerpt


class ArgumentError(StickSlipError, ValueError):
    """An argument of a function is wrong.

    Attributes:
        argument: its name.
        value: its value, as text.
    """

    def __init__(
        self, message: str, *, argument: str = "", value: str = "", problem: str = "", remedy: str = ""
    ) -> None:
        super().__init__(message, problem=problem, remedy=remedy)
        self.argument = argument
        self.value = value


class RunError(StickSlipError, RuntimeError):
    """A run, a trade or a calibration has no result."""


class VerificationError(RunError):
    """A number is another one than its scenario and its seed come to.

    Attributes:
        variable: the variable or attribute.
        path: number of the path, for rows of single paths.
        index: which of its values, from 0: those of the path, or those of the data set.
        stored: what is there.
        computed: what its scenario comes to.
    """

    def __init__(
        self,
        message: str,
        *,
        variable: str = "",
        path: int | None = None,
        index: int = 0,
        stored: str = "",
        computed: str = "",
        problem: str = "",
        remedy: str = "",
    ) -> None:
        super().__init__(message, problem=problem, remedy=remedy)
        self.variable = variable
        self.path = path
        self.index = index
        self.stored = stored
        self.computed = computed


class StickSlipWarning(UserWarning):
    """In what way a result is not what it seems to be."""


def wrong_argument(argument: str, value: object, problem: str, remedy: str) -> ArgumentError:
    """The exception about an argument."""
    message = f"{argument} = {value}: {problem}\n  fix: {remedy}"
    return ArgumentError(message, argument=argument, value=str(value), problem=problem, remedy=remedy)
