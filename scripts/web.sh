#!/usr/bin/env bash
# Pages: the core inside them learns what the program learns, byte for byte, and headless Chromium opens, plays, drags,
# pushes and prints them. `--update` first builds the core anew, after a change to what learns or controls; `--core` leaves
# Chromium out; `--look FOLDER` keeps the pictures.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/skip.sh"
cd "$(dirname "${BASH_SOURCE[0]}")/.."
export CARGO_TARGET_DIR="${CARGO_TARGET_DIR:-$PWD/target}"
core=crates/hpf/src/page/core
with_browser=true
while [ $# -gt 0 ]; do
    case "$1" in
    --update) web/build.sh "$PWD/$core" ;;
    --core) with_browser=false ;;
    --look) export HPF_PICTURES="$2" && shift ;;
    *) echo "usage: $0 [--update] [--core] [--look FOLDER]" >&2 && exit 2 ;;
    esac
    shift
done

if ! command -v node >/dev/null || ! command -v npm >/dev/null; then
    install_packages nodejs npm || skip "no node, and it cannot be installed" "pages were not tested"
fi
if $with_browser && ! command -v chromium >/dev/null; then
    install_packages chromium fonts-dejavu-core || skip "no chromium, and it cannot be installed" "pages were not tested"
fi

echo "== no file is too large for the repository, and none names a place of the machine that made it"
for file in "$core"/*; do
    [ "$(stat -c %s "$file")" -le 1048576 ] || { echo "FAILED: $file is above 1 MiB"; exit 1; }
done
if gzip -dc "$core/core.wasm.gz" | grep -qa "/\.cargo/registry\|/home/"; then
    echo "FAILED: $core/core.wasm.gz names folders of the machine that made it"
    exit 1
fi
cargo build --quiet -p hpf-cli
export HPF_PROGRAM="$CARGO_TARGET_DIR/debug/hpf"
echo "== the core in pages agrees with the program; where it does not: $0 --update"
node --test --test-reporter=spec web/test/core.mjs
if $with_browser; then
    echo "== pages in Chromium"
    modules="$CARGO_TARGET_DIR/web-node"
    mkdir -p "$modules"
    if ! [ -d "$modules/node_modules/puppeteer-core" ]; then
        npm install --silent --no-audit --no-fund --prefix "$modules" puppeteer-core@25 ||
            skip "puppeteer-core cannot be installed" "pages were not opened"
    fi
    HPF_PUPPETEER="$(find "$modules/node_modules/puppeteer-core" -name puppeteer-core.js | head -n 1)" CHROMIUM="$(command -v chromium)" \
        node --test --test-reporter=spec web/test/page.mjs
fi
