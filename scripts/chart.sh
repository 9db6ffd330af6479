#!/usr/bin/env bash
# Draws the chart and keeps it. See usage below.
set -eu
cd -P "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'END'
Usage: scripts/chart.sh [option of "ragtop_bench chart"]...
       scripts/chart.sh --tables

Draws the chart with build/release/ragtop_bench on a machine that does nothing else, in out/chart, keeps its points as
bench/results/chart.csv and its picture as docs/pictures/chart.svg, and renews the tables of docs/chart.md, which
--tables does alone. What has changed can be drawn anew alone, beside what is kept:
  scripts/chart.sh --renew bench/results/chart.csv --scenes handle,rolling
END
}

case ${1:-} in -h | --help) usage && exit ;; esac
bench=build/release/ragtop_bench
if [ "${1:-}" != --tables ]; then
    "$bench" chart "$@" --out out/chart
    cp out/chart/chart.csv bench/results/chart.csv
    "$bench" chart --draw out/chart/chart.csv --scenes stopping,heavy-100,chain-planar --out out/chart/picture
    cp out/chart/picture/chart.svg docs/pictures/chart.svg
fi
# between(<mark> <text>): what stands in docs/chart.md from the mark to the next end.
between() {
    MARK=$1 TEXT=$2 awk '
        $0 == "<!-- " ENVIRON["MARK"] " -->" { print; print ""; print ENVIRON["TEXT"]; print ""; skip = 1; next }
        /<!-- end -->/ { skip = 0 }
        !skip { print }' docs/chart.md >docs/chart.md.new
    mv docs/chart.md.new docs/chart.md
}
between losses "$("$bench" chart --losses bench/results/chart.csv)"
between findings "$("$bench" chart --findings bench/results/chart.csv)"
between cheapest "$("$bench" chart --cheapest bench/results/chart.csv)"
between scenes "$("$bench" chart --scene-table)"
between economy "$("$bench" economy --table bench/results/economy.json)"
