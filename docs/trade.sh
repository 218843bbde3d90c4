#!/usr/bin/env bash
# Regenerate the table of docs/schemes.md, and the whole tables and pictures that it links to: about
# four minutes. `docs/trade.sh [BUDGET]`
set -euo pipefail
cd "$(dirname "$0")/.."
budget=${1:-45s}
shown='stick_duration_mean|first_stick|sticks_per_path|sub_phases_multiple|sticking_fraction|displacement_end_mean'
shown+='|drift_velocity|jump_abs_mean|friction_work'

cargo build --release --quiet --bin mc
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p docs/pictures
for scene in shaw rho025 equal-friction damped viaduct; do
    target/release/mc trade "scenarios/$scene.toml" --budget "$budget" -o "$folder/$scene.h5" > "docs/pictures/trade-$scene.txt"
    cp "$folder/$scene.svg" "docs/pictures/trade-$scene.svg"
    cp "$folder/$scene.png" "docs/pictures/trade-$scene.png"
    # Into the page: what 1 % costs for some statistics, in the block after the mark of the scene, if the page has one.
    sed -n '/^RMSE 1 %/,/^RMSE 0.1 %/{/^RMSE 0.1 %/!p}' "docs/pictures/trade-$scene.txt" | sed '$d' |
        grep -E "^(RMSE|$shown)" >"$folder/block"
    awk -v mark="<!-- $scene -->" -v block="$folder/block" '
        inside && /^```$/ { inside = 0 }
        !inside { print }
        $0 == mark { marked = 1 }
        marked && /^```text$/ { while ((getline line <block) > 0) print line; inside = 1; marked = 0 }
    ' docs/schemes.md >"$folder/page"
    cp "$folder/page" docs/schemes.md
done
