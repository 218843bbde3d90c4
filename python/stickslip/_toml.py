"""Write values and dictionaries as TOML, so that the parser of the engine reads them and its
messages quote them."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from .errors import wrong_argument


def document(scenario: Mapping[str, Any]) -> str:
    """A dictionary of tables as TOML text."""
    lines: list[str] = []
    _table("", scenario, lines)
    return "\n".join(lines) + "\n"


def value(key: str, given: object) -> str:
    """A value as TOML. `key` is its key in messages.

    Raises:
        ArgumentError: TOML has no values of this type.
    """
    plain = (
        given.item() if hasattr(given, "item") and not isinstance(given, (str, bytes)) else given
    )
    if isinstance(plain, bool):
        return "true" if plain else "false"
    if isinstance(plain, int):
        return str(plain)
    if isinstance(plain, float):
        return repr(plain) if math.isfinite(plain) else str(plain)
    if isinstance(plain, str):
        return json.dumps(plain, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(plain, Mapping):
        return (
            "{ "
            + ", ".join(f"{_name(k)} = {value(f'{key}.{k}', v)}" for k, v in plain.items())
            + " }"
        )
    if isinstance(plain, Sequence):
        return "[" + ", ".join(value(key, item) for item in plain) + "]"
    raise wrong_argument(
        key,
        repr(given),
        f"a scenario cannot hold values of type {type(given).__name__}",
        "give a number, a string, a bool, a list or a dictionary",
    )


def _table(path: str, table: Mapping[str, Any], lines: list[str]) -> None:
    """Append the values of a table to `lines`, then the tables in it. In TOML, a value after an
    inner table would belong to that inner table."""
    inner: list[tuple[str, Any]] = []
    for name, given in table.items():
        if isinstance(given, Mapping) or _is_tables(given):
            inner.append((name, given))
        else:
            lines.append(f"{_name(name)} = {value(f'{path}.{name}'.lstrip('.'), given)}")
    for name, given in inner:
        place = f"{path}.{_name(name)}".lstrip(".")
        for one in given if _is_tables(given) else [given]:
            lines.append("")
            lines.append(f"[[{place}]]" if _is_tables(given) else f"[{place}]")
            _table(place, one, lines)


def _is_tables(given: object) -> bool:
    if not isinstance(given, Sequence) or isinstance(given, (str, bytes)):
        return False
    return len(given) > 0 and all(isinstance(item, Mapping) for item in given)


def _name(name: object) -> str:
    text = str(name)
    is_bare = text != "" and all(c.isascii() and (c.isalnum() or c in "-_") for c in text)
    return text if is_bare else json.dumps(text, ensure_ascii=False)
