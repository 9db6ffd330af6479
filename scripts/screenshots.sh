#!/usr/bin/env bash
# Makes the pictures of README and docs. See usage below.
set -eu
cd -P "$(dirname "${BASH_SOURCE[0]}")/.."
. scripts/setup.sh

usage() {
    cat <<'END'
Usage: scripts/screenshots.sh [<folder>]

Installs what is missing, builds the program and the page, and takes a picture of each shipped scene in the page, with
Chromium: docs/pictures/<scene>.png, or in the folder named. RAGTOP_PROGRAM and RAGTOP_PAGE name what has been built
already.
END
}

case ${1:-} in
-h | --help)
    usage
    exit 0
    ;;
esac
folder=${1:-docs/pictures}

if [ -z "${RAGTOP_PROGRAM:-}" ] || [ -z "${RAGTOP_PAGE:-}" ]; then
    ragtop_setup run check
    scripts/page.sh build
    [ -e build/release/build.ninja ] || cmake --preset release -DRAGTOP_BUILD_TESTS=OFF -DRAGTOP_BUILD_BENCH=OFF
    cmake --build --preset release --target ragtop
fi
mkdir -p "$folder"
exec node scripts/screenshots.mjs "$folder"
