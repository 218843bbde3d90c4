#!/usr/bin/env bash
# Open reports in a headless Chromium, as described in tests/python/browser.py. `tools/setup --tests` installs the browser.
set -euo pipefail
cd "$(dirname "$0")/.."

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

look() { # NAME ARGUMENTS...
    cargo run --release --quiet --bin mc -- run scenarios/rho025.toml --quiet -o "$folder/$1.h5" "${@:2}" 2>"$folder/messages"
    cargo run --release --quiet --bin mc -- report "$folder/$1.h5" -o "$folder/$1.html" 2>"$folder/messages"
    target/venv/bin/python tests/python/browser.py "$folder/$1.h5" "$folder/$1.html"
}
look biased --paths 2000 --set units.time=s --set units.length=mm
look event-driven --paths 2000 --scheme event-driven
# A title that would run as a script if it were not escaped.
look hostile --paths 600 --set 'title="</script><script>window.stolen=1</script> <!-- <b>"'
