#!/bin/sh
# run.sh <number>: one acceptance test of the page; run.sh units: the tests of its modules. Ends with 77, "skipped", where something that it needs is missing;
# where CI is "true", that is a failure.
set -eu
here=$(dirname "$0")

missing() {
    echo "missing: $1: scripts/page.sh setup"
    [ "${CI:-}" = true ] && exit 1
    exit 77
}

command -v node >/dev/null || missing "node, 18 or newer"
if [ "$1" = units ]; then
    [ -d "$here/../../page/node_modules/three" ] || missing three
    exec node --test "$here"/../../page/test/*.test.mjs
fi
exec node "$here/acceptance_$1.mjs"
