"""Durations: numbers of seconds, strings such as "10m", and timedelta."""

from __future__ import annotations

import re
from datetime import timedelta
from typing import Union

from .errors import wrong_argument

#: A duration: seconds, a string such as "10m", "1.5h" or "1d 2h", or a timedelta.
Time = Union[float, str, timedelta]

_SECONDS = {"s": 1.0, "m": 60.0, "min": 60.0, "h": 3600.0, "d": 86_400.0}
_PIECE = re.compile(r"\s*(\d+\.?\d*|\.\d+)\s*(s|min|m|h|d)", re.ASCII)


def seconds(argument: str, time: Time) -> float:
    """A duration in seconds.

    Raises:
        ArgumentError: it is not positive, too long, or not a duration. The error names
            `argument`.
    """
    length = _length(time)
    if not 0 < length < 1e12:
        raise wrong_argument(
            argument,
            repr(time) if isinstance(time, str) else time,
            "it is not a positive duration",
            'give seconds, a string such as "10m", "1.5h" or "1d 2h", or a timedelta',
        )
    return length


def _length(time: Time) -> float:
    """The duration in seconds; NaN if a string is not one."""
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
