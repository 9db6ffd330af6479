#!/bin/sh
# same_hash.sh <build folder>: the shipped scenes end with the same state in every build of the program that is there.
set -eu
build=$1
failed=0
for scene in tower rain crash; do
    reference=
    for preset in release debug clang clang19; do
        program=$build/$preset/ragtop
        [ -x "$program" ] || { echo "$preset is not built"; exit 1; }
        hash=$("$program" run $scene --steps 60 2>/dev/null | sed -n 's/.*"hash": "\([0-9a-f]*\)".*/\1/p')
        echo "$scene $preset $hash"
        reference=${reference:-$hash}
        [ -n "$hash" ] && [ "$hash" = "$reference" ] || failed=1
    done
done
exit $failed
