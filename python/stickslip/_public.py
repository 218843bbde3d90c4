"""What every public function does: it suggests names for unknown arguments, and names an argument
whose type the engine refuses."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from functools import wraps
from typing import ParamSpec, TypeVar

from . import _native
from .errors import wrong_argument

P = ParamSpec("P")
R = TypeVar("R")

#: Arguments that replace a key of the scenario, and the key.
KEYS = {
    "paths": "ensemble.paths",
    "seed": "ensemble.seed",
    "scheme": "scheme.kind",
    "tolerance": "scheme.tolerance",
    "step": "time.step",
    "until": "time.end",
}


def public(function: Callable[P, R]) -> Callable[P, R]:
    """The function with these checks.

    Raises:
        TypeError: an argument is unknown. The message suggests another.
        ArgumentError: the engine refuses the type of an argument.
    """
    names = [name for name in inspect.signature(function).parameters if name != "self"]
    called = function.__qualname__.removesuffix(".__init__")

    @wraps(function)
    def call(*given: P.args, **named: P.kwargs) -> R:
        for name in named.keys() - {*names}:
            problem = f"{called}() has no argument `{name}`"
            raise TypeError(f"{problem}\n  fix: {_instead(name, names)}")
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


def _instead(word: str, names: Iterable[str]) -> str:
    """The argument, or the key of the scenario, that a word probably stands for."""
    alike = get_close_matches(word, names, 1)
    key, meaning = _native.key_meant(word) or ("", "")
    alike += [argument for argument, of in KEYS.items() if of == key and argument in names]
    if alike:
        return f"write `{alike[0]}=`"
    if key and "set" in names:
        return f'write `set={{"{key}": ...}}` for that key of the scenario ({meaning})'
    return f"the arguments are {', '.join(names)}"
