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

Every name of the package `stickslip`, with its arguments, results and errors.
[Work in Python](python.md) shows how they are used.
`tools/python_api.py` writes this page from the docstrings, which `help` shows as well.
"""

#: The sections of a docstring whose entries have names.
ENTRIES = {
    "Args": "Arguments",
    "Attributes": "Attributes",
    "Raises": "Errors",
    "Warns": "Warnings",
}


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
    parts += [of_class(name, thing) for name, thing in errors.items()]
    parts.append("## Constants and types\n")
    parts += [f"- `{name}`: {text}" for name, text in sorted(commented())]
    return "\n".join(parts) + "\n"


def called(name, function, receiver=""):
    """A function or a method with its signature."""
    signature = inspect.signature(function)
    kept = [p for p in signature.parameters.values() if p.name != "self"]
    rows, is_keyword = [], False
    for one in kept:
        if one.kind is one.KEYWORD_ONLY and not is_keyword:
            rows.append("*")
            is_keyword = True
        default = "" if one.default is one.empty else f" = {one.default!r}"
        rows.append(f"{one.name}: {one.annotation}{default}")
    inside = "".join(f"\n    {row}," for row in rows) + "\n" if len(rows) > 1 else "".join(rows)
    code = f"{receiver or name}({inside}) -> {signature.return_annotation}"
    return f"### {name}\n\n```python\n{code}\n```\n\n{markdown(function.__doc__)}"


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
    """Names with a comment `#:` before them, and that comment."""
    for file in Path(stickslip.__file__).parent.glob("*.py"):
        for comment, name in re.findall(r"((?:^#: .*\n)+)(\w+)", file.read_text(), re.M):
            if name == "__version__" or not name.startswith("_"):
                yield name, " ".join(comment.replace("#:", "").split())


def markdown(docstring):
    """A docstring as Markdown, with one sentence a line."""
    parts = re.split(r"^(\w+):\n((?:    .*\n|\n)+)", inspect.cleandoc(docstring) + "\n", flags=re.M)
    texts = [paragraphs(parts[0])]
    for heading, body in zip(parts[1::3], parts[2::3]):
        body = textwrap.dedent(body)
        if heading not in ENTRIES:
            texts.append(f"**{heading}**\n\n{paragraphs(body)}")
            continue
        entries = re.findall(r"^(\S[^:]*): (.*(?:\n +.*)*)", body, re.M)
        rows = [f"- {quoted(names)}: {sentences(text, '  ')}" for names, text in entries]
        texts.append(f"**{ENTRIES[heading]}**\n\n" + "\n".join(rows) + "\n")
    return "\n".join(texts)


def paragraphs(text):
    return "\n".join(sentences(part) + "\n" for part in text.strip().split("\n\n"))


def sentences(text, indent=""):
    """A paragraph with each sentence on a line of its own."""
    return re.sub(r"(?<!e\.g)\. (?=[A-Z`])", f".\n{indent}", " ".join(text.split()))


def quoted(names):
    return ", ".join(f"`{name}`" for name in names.replace("\n", " ").split(", "))


if __name__ == "__main__":
    print(page(), end="")
