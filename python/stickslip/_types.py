"""Check the types of arguments."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from datetime import timedelta
from numbers import Integral, Real
from typing import Any

from .errors import wrong_argument


def _is_text(given: Any) -> bool:
    return isinstance(given, str)


def _are_texts(given: Any) -> bool:
    return _is_text(given) or isinstance(given, Iterable) and all(map(_is_text, given))


def _is_number(given: Any) -> bool:
    return isinstance(given, Real) and not isinstance(given, bool)


def _is_whole(given: Any) -> bool:
    return isinstance(given, Integral) and _is_number(given) and 0 <= int(given) < 2**64


def _is_truth(given: Any) -> bool:
    return isinstance(given, bool) or type(given).__name__ in ("bool_", "bool")


def _is_table(given: Any) -> bool:
    return isinstance(given, Mapping)


def _is_dataset(given: Any) -> bool:
    return hasattr(given, "data_vars") and hasattr(given, "attrs")


#: For each annotation, a test and the fix for a value that fails it.
_ASKED: dict[str, tuple[Callable[[Any], bool], str]] = {
    "str": (_is_text, "give a string"),
    "Sequence[str]": (_are_texts, "give a list of strings"),
    "str | Sequence[str]": (_are_texts, "give a string or a list of strings"),
    "float": (_is_number, "give a number"),
    "int": (_is_whole, "give an integer, 0 or above"),
    "bool": (_is_truth, "give True or False"),
    "Time": (
        lambda given: _is_number(given) or isinstance(given, (str, timedelta)),
        'give seconds, a string such as "10m", or a timedelta',
    ),
    "Settings": (_is_table, 'give a dictionary, e.g. {"friction.static": 1.3}'),
    "Mapping[str, Statistic]": (_is_table, "give a dictionary of functions by name"),
    "Mapping[str, Values]": (_is_table, "give a dictionary of values by key"),
    "Mapping[str, tuple[float, float]]": (_is_table, "give a dictionary of pairs by key"),
    "Mapping[str, Any]": (_is_table, "give a dictionary"),
    "Until": (
        lambda given: _is_number(given) or _are_texts(given),
        'give a number, or a goal such as "stick_duration_mean < 0.5%", or a list of goals',
    ),
    "Record": (
        lambda given: _is_table(given) or _are_texts(given),
        'give a name such as "events", a list of names, or a dictionary',
    ),
    "Progress": (
        lambda given: given is None or isinstance(given, bool) or callable(given),
        "give True, or a callable f(done, expected)",
    ),
    "xr.Dataset": (
        _is_dataset,
        "give what a function of this package returned, or load() of its file",
    ),
    "Sequence[xr.Dataset]": (
        lambda given: isinstance(given, Iterable) and not _is_dataset(given),
        "give a list of data sets",
    ),
}

#: Arguments that the engine checks, because they replace keys of a scenario or have messages of
#: their own.
_OF_THE_ENGINE = ("paths", "seed", "scheme", "step", "tolerance", "until", "threads")


def checked(function: Callable[..., Any], given: Mapping[str, Any]) -> None:
    """Compare the arguments of a public function, `locals()` at its start, with its annotations.

    Raises:
        ArgumentError: one of them has a wrong type.
    """
    for name, annotation in function.__annotations__.items():
        kind = str(annotation)
        is_optional = kind.endswith(" | None")
        kind = kind[: -len(" | None")] if is_optional else kind
        is_of_engine = is_optional and name in _OF_THE_ENGINE and kind != "Until"
        if name == "return" or kind not in _ASKED or is_of_engine:
            continue
        value = given[name]
        is_such, remedy = _ASKED[kind]
        if not (is_optional and value is None or is_such(value)):
            is_short = value is None or isinstance(value, (str, Real))
            shown = repr(value) if is_short else type(value).__name__
            raise wrong_argument(name, shown, "wrong type or out of range", remedy)
