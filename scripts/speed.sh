#!/usr/bin/env bash
# Times all scenes and keeps the result. See usage below.
set -eu
cd -P "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'END'
Usage: scripts/speed.sh [option of "ragtop_bench speed"]...

Times build/release/ragtop_bench on a machine that does nothing else, keeps the rows as
bench/results/speed/<time>_<commit>_<processor>.json, and renews the tables of docs/speed.md: that of the newest rows, and
that of the ratios of all that are kept.
END
}

case ${1:-} in -h | --help) usage && exit ;; esac
bench=build/release/ragtop_bench
commit=$(git describe --always --dirty)
processor=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo | head -n 1 | tr -cs 'A-Za-z0-9\n' '-')
file=bench/results/speed/$(date -u +%Y-%m-%dT%H%M)_${commit}_${processor%-}-$(nproc).json
mkdir -p bench/results/speed
"$bench" speed "$@" --json "$file"
# between(<mark> <text>): what stands in docs/speed.md from the mark to the next end.
between() {
    MARK=$1 TEXT=$2 awk '
        $0 == "<!-- " ENVIRON["MARK"] " -->" { print; print ""; print ENVIRON["TEXT"]; print ""; skip = 1; next }
        /<!-- end -->/ { skip = 0 }
        !skip { print }' docs/speed.md >docs/speed.md.new
    mv docs/speed.md.new docs/speed.md
}
# An error ends this before anything is written.
kept=$("$bench" speed --history bench/results/speed)
newest=$("$bench" speed --newest bench/results/speed)
between "kept results" "$kept"
between "newest result" "$newest"
