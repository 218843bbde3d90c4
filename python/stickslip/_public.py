"""What every public function does: it suggests names for unknown arguments, and names an argument
whose type the engine refuses."""

from __future__ import annotations

import inspect
import re
import reprlib
from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from . import _native
from .errors import wrong_argument

P = ParamSpec("P")
R = TypeVar("R")

#: Arguments that replace a key of the scenario, and the key.
KEYS: dict[str, str] = dict(_native.OPTIONS)


def public(function: Callable[P, R]) -> Callable[P, R]:
    """The function with these checks.

    Raises:
        ArgumentError: an argument is unknown, for which the message suggests another, or the
            engine refuses its type.
    """
    names = [name for name in inspect.signature(function).parameters if name != "self"]
    called = function.__qualname__.removesuffix(".__init__")

    @wraps(function)
    def call(*given: P.args, **named: P.kwargs) -> R:
        for name in named.keys() - {*names}:
            problem = f"{called}() has no such argument"
            raise wrong_argument(name, reprlib.repr(named[name]), problem, _instead(name, names))
        try:
            return function(*given, **named)
        except (TypeError, OverflowError) as error:
            # The engine says it in the message, or in a note where Python has notes.
            said = "\n".join([str(error), *getattr(error, "__notes__", [])])
            refused = re.search(r"(?:argument|while processing) '(\w+)'", said)
            if refused is None or refused[1] not in names:
                raise
            value = named.get(refused[1], "this value")
            remedy = f"give what help(stickslip.{called}) says"
            raise wrong_argument(refused[1], repr(value), str(error), remedy) from None

    return call


def _instead(word: str, names: list[str]) -> str:
    """The argument, or the key of the scenario, that a word probably stands for."""
    meant = _native.option_meant(word, names)
    if meant:
        return f"write `{meant}=`"
    key, meaning = _native.key_meant(word) or ("", "")
    if key and "set" in names:
        return f'write `set={{"{key}": ...}}` for that key of the scenario ({meaning})'
    return f"the arguments are {', '.join(names)}"
