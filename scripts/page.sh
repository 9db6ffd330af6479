#!/usr/bin/env bash
# Builds the browser page, build/page/ragtop.html. See usage below; ./run and ./check use it too.
set -eu
cd -P "$(dirname "${BASH_SOURCE[0]}")/.."
. scripts/setup.sh

usage() {
    cat <<'END'
Usage: scripts/page.sh build|setup|--help

  build  installs what is missing and bundles page/ into build/page/ragtop.html, one file that needs no other
  setup  only installs: node and npm, where there are none yet, and the packages of page/package-lock.json
END
}

# Debian's packages and other builds of node exclude each other, so what is there is used.
setup_tools() {
    command -v node >/dev/null || ragtop_setup node
    command -v npm >/dev/null || ragtop_setup npm
    local major
    major=$(node -p 'process.versions.node.split(".")[0]')
    if [ "$major" -lt 18 ]; then
        echo "page: node is version $major, must be 18 or newer" >&2
        return 1
    fi
}

# npm leaves a list of what it has installed; while that is newer than the wanted one, nothing is to be done.
setup_packages() {
    [ ! page/node_modules/.package-lock.json -nt page/package-lock.json ] || return 0
    echo "Installing the packages of page/package-lock.json"
    npm --prefix page ci --prefer-offline --no-audit --no-fund --ignore-scripts
}

case ${1:---help} in
-h | --help) usage ;;
setup)
    setup_tools
    setup_packages
    ;;
build)
    setup_tools
    setup_packages
    npm --prefix page run --silent build
    ;;
*)
    echo "page: unknown command $1" >&2
    usage >&2
    exit 2
    ;;
esac
