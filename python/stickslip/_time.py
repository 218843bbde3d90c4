"""Lengths of time: numbers of seconds, texts such as "10m", and timedelta."""

from __future__ import annotations

import re
from datetime import timedelta
from typing import Union

from .errors import wrong_argument

#: A length of time: seconds, a text such as "10m", "1.5h" or "1d 2h", or a timedelta.
Time = Union[float, str, timedelta]

_SECONDS = {"s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0, "d": 86_400.0}
_PIECE = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*(s|min|m|h|d)", re.ASCII)


def seconds(argument: str, time: Time) -> float:
    """A length of time in seconds.

    Raises:
        ArgumentError: it is not above zero, too long, or no length of time. The error names
            `argument`.
    """
    length = _length(time)
    if not 0 < length < 1e12:
        raise wrong_argument(
            argument,
            repr(time) if isinstance(time, str) else time,
            "it is no time above zero",
            'give a number of seconds, a text such as "10m", "1.5h" or "1d 2h", or a timedelta',
        )
    return length


def _length(time: Time) -> float:
    """The length in seconds; NaN where a text is none."""
    if isinstance(time, timedelta):
        return time.total_seconds()
    if not isinstance(time, str):
        return float(time)
    if _PIECE.sub("", time).strip():
        try:
            return float(time)
        except ValueError:
            return float("nan")
    return sum(float(number) * _SECONDS[unit] for number, unit in _PIECE.findall(time))
