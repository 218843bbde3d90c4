#!/usr/bin/env bash
# Build the package for Python as a user does, and test it beside the command, which must have been
# built with: cargo build --release.
set -euo pipefail
cd "$(dirname "$0")/.."

venv=target/venv-python
[ -x "$venv/bin/pip" ] || python3 -m venv "$venv"
"$venv/bin/pip" install --quiet --disable-pip-version-check -r python/tests/requirements.txt
# The library is built where the command was, so that their common parts are built once.
"$venv/bin/pip" install --quiet --disable-pip-version-check --force-reinstall --no-deps ./python
(cd python && "../$venv/bin/mypy" --no-error-summary)
"$venv/bin/pytest" --quiet -p no:cacheprovider python/tests
