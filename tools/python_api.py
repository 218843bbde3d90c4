#!/usr/bin/env python3
"""Prints docs/python-api.md from the docstrings of the installed package:

    target/venv-python/bin/python tools/python_api.py >docs/python-api.md
"""

import inspect
import re
import textwrap
from pathlib import Path

import stickslip

INTRODUCTION = """\
# The package for Python

Every function of the package `stickslip` with its arguments, and every class.
[Work in Python](python.md) shows how they are used, and `help(ss.run)` describes all values of its arguments, its result, and its errors.
An argument without a line of its own is the flag of the command of the same name (`mc help run`), or that of [`run`](#run) or [`calibrate`](#calibrate); the result is a [data set](output-format.md) where no type is given.
A duration is a number of seconds, a string such as "10m", or a timedelta.
`tools/python_api.py` writes this page from the docstrings.
"""

#: Arguments that the page explains: those that are no flags of the command.
EXPLAINED = {
    "run": "scenario until set record temperature inputs own progress",
    "calibrate": "data displacement",
    "plot": "subject",
    "sweep": "vary",
    "verify": "run",
}

#: The sections of a docstring whose entries are on the page.
ENTRIES = ["Args", "Attributes"]


def page():
    """The text of the page."""
    names = {name: getattr(stickslip, name) for name in stickslip.__all__}
    classes = {n: thing for n, thing in names.items() if inspect.isclass(thing)}
    errors = {n: thing for n, thing in classes.items() if issubclass(thing, Exception)}
    parts = [INTRODUCTION, "## Functions\n"]
    parts += [called(name, thing) for name, thing in names.items() if inspect.isfunction(thing)]
    parts.append("## Classes\n")
    parts += [of_class(name, thing) for name, thing in classes.items() if name not in errors]
    parts.append("## Exceptions and warnings\n")
    parts.append("Their attributes are [in a table](python.md#a-scenario).\n")
    for name, thing in errors.items():
        parts.append(f"### {name}\n\n{sentences(thing.__doc__.split(chr(10) * 2)[0])}\n")
    parts.append("## Constants and types\n")
    parts += [f"- `{name}`: {text}" for name, text in sorted(commented())]
    return "\n".join(parts) + "\n"


def called(name, function, receiver=""):
    """A function or a method with its arguments and their defaults, without their types."""
    rows, is_keyword = [], False
    for one in inspect.signature(function).parameters.values():
        if one.name == "self":
            continue
        if one.kind is one.KEYWORD_ONLY and not is_keyword:
            rows.append("*")
            is_keyword = True
        rows.append(one.name if one.default is one.empty else f"{one.name}={one.default!r}")
    code = textwrap.fill(", ".join(rows), 90, subsequent_indent="    ", break_on_hyphens=False)
    result = inspect.signature(function).return_annotation
    result = "" if result == "xr.Dataset" else f" -> {result}"
    head = f"### {name}\n\n```python\n{receiver or name}({code}){result}\n```\n\n"
    return head + markdown(function.__doc__, None if receiver else EXPLAINED.get(name, ""))


def of_class(name, thing):
    """A class with the methods and properties that it defines."""
    parts = [f"### {name}\n\n{markdown(thing.__doc__)}"]
    for member, value in vars(thing).items():
        if member.startswith("_"):
            continue
        if isinstance(value, property):
            parts.append(f"#### {name}.{member}\n\n{markdown(value.__doc__)}")
        elif inspect.isfunction(value):
            parts.append("#" + called(f"{name}.{member}", value, member))
    return "\n".join(parts)


def commented():
    """Public names with a comment `#:` before them, and that comment."""
    for file in Path(stickslip.__file__).parent.glob("*.py"):
        for comment, name in re.findall(r"((?:^#: .*\n)+)(\w+)", file.read_text(), re.M):
            if name in stickslip.__all__:
                yield name, " ".join(comment.replace("#:", "").split())


def markdown(docstring, explained=None):
    """A docstring as Markdown: its first paragraph, the first sentence on each argument that is
    explained, and the names of attributes. `help` has the rest."""
    parts = re.split(r"^(\w+):\n((?:    .*\n|\n)+)", inspect.cleandoc(docstring) + "\n", flags=re.M)
    texts = [sentences(parts[0].strip().split("\n\n")[0]) + "\n"]
    for heading, body in zip(parts[1::3], parts[2::3]):
        body = textwrap.dedent(body)
        if heading in ENTRIES:
            entries = re.findall(r"^(\S[^:]*): (.*(?:\n +.*)*)", body, re.M)
            if explained is not None:
                entries = [(names, text) for names, text in entries if names in explained.split()]
            rows = "".join(f"- {quoted(names)}: {first(text)}\n" for names, text in entries)
            if heading == "Attributes":
                rows = f"Attributes: {', '.join(quoted(names) for names, _ in entries)}.\n"
            texts.append(rows)
    return "\n".join(text for text in texts if text)


def first(text):
    """The first sentence of a text."""
    text = " ".join(text.split()).replace(', as a text such as "10m", or as a timedelta', "")
    return re.split(r"(?<=\.)(?<!e\.g\.) (?=[A-Z`])", text)[0]


def sentences(text):
    """A paragraph with each sentence on a line of its own."""
    return re.sub(r"(?<!e\.g)\. (?=[A-Z`])", ".\n", " ".join(text.split()))


def quoted(names):
    return ", ".join(f"`{name}`" for name in re.split(r",\s+", names))


if __name__ == "__main__":
    print(page(), end="")
