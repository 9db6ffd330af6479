#!/bin/sh
# layering.sh <source tree>: checks the rules that keep the modules apart and the files readable.
#
#   core <- vehicles, ragdolls <- cooked <- assets <- demos; vehicles and ragdolls do not know each other
#   public headers include only the standard library and public headers (ragtop/eigen.h may include Eigen),
#   define no macros, start with #pragma once
#   no header has a using-directive
#   no module uses the algorithms that stop clang 19 with libstdc++ 12
#   no extreme of the stability suite is kept in a way that loses NaN
#   no file is longer than 500 lines, no function of a module longer than 80, of core 60 without a reason
#   folders of core include what the table in docs/architecture.md says, headers of systems have at most 150 lines
#   no class of core has more than 30 public member functions or 25 fields, and World's implementation no more than 15,
#   but for ceilings.txt, which only falls
#   every named number of core says what it is, but for constants.txt, which only falls
set -eu
here=$(cd "$(dirname "$0")" && pwd)
cd "$1"

modules="core vehicles ragdolls cooked assets demos"
sources=$(find $modules tests bench -type f \( -name '*.h' -o -name '*.inl' -o -name '*.cpp' \) 2>/dev/null | LC_ALL=C sort)

allowed_modules() {
    case $1 in
    core) echo core ;;
    vehicles | ragdolls) echo "core $1" ;;
    cooked) echo "core ragdolls cooked" ;;
    assets) echo "core vehicles ragdolls cooked assets" ;;
    demos) echo "core vehicles ragdolls cooked assets demos" ;;
    esac
}

check_module() {
    module=$1
    files=$(echo "$sources" | grep "^$module/" || true)
    [ -n "$files" ] || return 0
    allowed=$(allowed_modules "$module")
    # Public headers by the name they are included as, and the module's own private files by theirs.
    public=$(for m in $allowed; do
        [ ! -d "$m/include" ] || (cd "$m/include" && find . -name '*.h' | sed 's|^\./||')
    done)
    private=$([ ! -d "$module/src" ] || (cd "$module/src" && find . -type f | sed 's|^\./||'))
    result=0
    awk -v public="$public" -v private="$private" -v module="$module" -f "$here/includes.awk" $files || result=1
    awk -f "$here/functions.awk" $files || result=1
    return $result
}

status=0
for module in $modules; do
    check_module "$module" || status=1
done
if [ -n "$sources" ]; then
    awk 'FNR == 1 { over = 0 }
         FNR > 500 && !over { over = 1; failed = 1; print FILENAME ": longer than 500 lines" }
         END { exit failed }' $sources || status=1
    # std::max and std::min drop what is no number, with which the worst of a run would pass.
    if grep -nE '([A-Za-z_.]+) = std::(max|min)\(\{?\1[,)]' $(echo "$sources" | grep '^bench/stability/'); then
        echo "extremes that drop NaN, which larger and smaller (bench/stability/extremes.h) keep (above)"
        status=1
    fi
    # They take their memory from std::get_temporary_buffer, which C++17 deprecates and clang 19 refuses.
    if grep -nE 'std::(ranges::)?(stable_sort|stable_partition|inplace_merge)' $sources; then
        echo "algorithms with a temporary buffer (above): sort by a total order instead"
        status=1
    fi
    headers=$(echo "$sources" | grep -E '\.(h|inl)$' || true)
    if [ -n "$headers" ] && grep -nE '^[[:space:]]*using[[:space:]]+namespace' $headers; then
        echo "using-directives in headers (above)"
        status=1
    fi
fi
if [ -d core/src ] && [ -f docs/architecture.md ]; then
    core=$(echo "$sources" | grep '^core/src/')
    awk -f "$here/folders.awk" docs/architecture.md $core || status=1
    awk -v ceilings="$here/ceilings.txt" -f "$here/classes.awk" $(echo "$sources" | grep '^core/') || status=1
    bare=$(awk -f "$here/constants.awk" $core)
    count=$(echo "$bare" | grep -c . || true)
    most=$(cat "$here/constants.txt")
    if [ "$count" -gt "$most" ]; then
        echo "$bare"
        echo "$count numbers without a word (above), at most $most by constants.txt: say what they are"
        status=1
    fi
fi
[ $status -ne 0 ] || echo "$(echo "$sources" | wc -l) files keep to the rules"
exit $status
