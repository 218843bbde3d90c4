"""Messages of the engine, in terms of Python.

The engine speaks to users of the command as well, so some of its advice names a flag or another
command. Here it names the argument or the function instead.
"""

from __future__ import annotations

import re

_IN_PYTHON = [
    (re.compile(pattern), words)
    for pattern, words in (
        (r"`--(scheme) ([a-z-]+)`", r'`\1="\2"`'),
        (r"try --lag auto", r"leave out lag"),
        (r"`--(threads)`|--(lag|starts|step|vary|elasticity)\b", r"\1\2"),
        (r"a file of `mc (run|sweep|trade|calibrate)`", r"a result of \1()"),
        (r"`mc run --part`", "run(..., part=...)"),
        (
            r"`([\w-]+)` alone is the shipped scenario, and `mc init --from [\w-]+` writes it",
            r'"\1" names the shipped one',
        ),
        (r"; `mc init` writes one", ", or the name of one of scenarios()"),
        (r"`mc init` prints a scenario to start from", 'check("rho025").toml is one to start from'),
        (r"`mc check` prints every key of a scenario", "check(scenario).toml has every key"),
        (
            r"`mc show (.+)` shows the results in it, and `mc show .+ --scenario` prints "
            r"their scenario",
            r'load("\1") opens it, and its attribute `scenario` is the scenario of its results',
        ),
    )
]


def in_python(message: str) -> str:
    """The message with arguments and functions in place of flags and commands."""
    for pattern, words in _IN_PYTHON:
        message = pattern.sub(words, message)
    return message
