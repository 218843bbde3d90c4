#!/usr/bin/env bash
# Regenerate the tables and pictures of docs/trade.md: about four minutes. `docs/trade.sh [BUDGET]`
set -euo pipefail
cd "$(dirname "$0")/.."
budget=${1:-45s}

cargo build --release --quiet --bin mc
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p docs/pictures
for scene in shaw rho025 equal-friction damped viaduct; do
    target/release/mc trade "scenarios/$scene.toml" --budget "$budget" -o "$folder/$scene.h5" > "docs/pictures/trade-$scene.txt"
    cp "$folder/$scene.svg" "docs/pictures/trade-$scene.svg"
    cp "$folder/$scene.png" "docs/pictures/trade-$scene.png"
done
