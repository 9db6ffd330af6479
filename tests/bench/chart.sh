#!/bin/sh
# What `ragtop_bench chart` promises to those who read its output; its times are not looked at.
# Usage: chart.sh <ragtop_bench> <source tree>
set -eu
program=$1
tree=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
    echo "chart: $1" >&2
    exit 1
}

# refuses <words of the message> <option>...: one line says what is wrong.
refuses() {
    words=$1
    shift
    if "$program" chart "$@" >"$folder/out" 2>&1; then fail "$* is accepted"; fi
    grep -qF -- "$words" "$folder/out" || fail "$*: does not say \"$words\" but $(cat "$folder/out")"
    [ "$(grep -c . "$folder/out")" -le 2 ] || fail "$*: says more than it must: $(cat "$folder/out")"
}

refuses '"nonsense" is no scene, must be one of stopping' --scenes nonsense
refuses '"nonsense" is no engine, must be one of ragtop' --engines nonsense
refuses '"nonsense" is no point, must be like' --point nonsense
refuses 'cannot be made' --scenes stopping --engines ragtop --out /dev/null/chart
refuses "$folder/absent.csv: cannot be read" --draw "$folder/absent.csv"
echo 'scene,error' >"$folder/other.csv"
refuses "$folder/other.csv:1: does not begin with the columns of ragtop-chart-1" --losses "$folder/other.csv"

# What lines promise besides times, which are the last four columns.
columns='schema,point,points,scene,quantity,unit,reference_kind,engine,version,variant,step_s,substeps,iterations,default,seed,digest,outcome,failed_at_s,value,reference,error,error_low,error_high,self_consistency,contacts,passes,simulated_s,repeats,reason,command,alone,cpu_ms,cpu_ms_low,cpu_ms_high'
without_times() { sed 's/\(,[^,]*\)\{4\}$//' "$1"; }

"$program" chart --quick --scenes stopping --repeats 1 --out "$folder/first" >"$folder/out" 2>&1 ||
    [ ! -f "$tree/build/page/chart.html" ] || fail "the sweep fails: $(tail -n 3 "$folder/out")"
csv=$folder/first/chart.csv
[ "$(head -n 1 "$csv")" = "$columns" ] || fail "the columns are other ones"
[ "$(sed 1d "$csv" | grep -c '^ragtop-chart-1,')" -eq "$(sed 1d "$csv" | wc -l)" ] || fail "a line has no schema"
grep -q '^[^,]*,[^,]*,[^,]*,stopping,distance,m,closed form,ragtop,[^,]*,ragtop,[^,]*,4,0,1,' "$csv" ||
    fail "Ragtop's default is not there"
grep -q ',stopping/ragtop@60x4i0,\|ragtop_bench chart --point .stopping/ragtop@60x4i0.' "$csv" || fail "no command repeats a point"

# A journal that is cut off anywhere leads to the same lines.
size=$(wc -c <"$folder/first/journal")
mkdir "$folder/second"
head -c $((size * 2 / 3)) "$folder/first/journal" >"$folder/second/journal"
"$program" chart --quick --scenes stopping --repeats 1 --resume --out "$folder/second" >"$folder/out" 2>&1 || true
without_times "$csv" >"$folder/a"
without_times "$folder/second/chart.csv" >"$folder/b"
cmp "$folder/a" "$folder/b" || fail "a resumed sweep ends otherwise"
[ "$(grep -c error "$folder/out")" -lt "$(sed 1d "$csv" | wc -l)" ] || fail "nothing was taken from the journal"

# Some points of a sweep that is kept are measured anew, and the others stay.
set -- chart --quick --engines ragtop --repeats 1
"$program" "$@" --scenes stopping,handle --out "$folder/both" >"$folder/out" 2>&1 || true
"$program" "$@" --scenes handle --renew "$folder/both/chart.csv" --out "$folder/renewed" >"$folder/out" 2>&1 || true
without_times "$folder/both/chart.csv" >"$folder/a"
without_times "$folder/renewed/chart.csv" >"$folder/b"
cmp "$folder/a" "$folder/b" || fail "a sweep that is renewed in part ends otherwise: $(tail -n 2 "$folder/out")"

# A disk that fills up on the way ends the sweep with a line; a file that may not grow fills up alike.
if (trap '' XFSZ; ulimit -f 8; exec "$program" chart --quick --scenes stopping --repeats 1 --out "$folder/full" \
    >/dev/null 2>"$folder/full.txt"); then fail "a full disk is not noticed"; fi
[ "$(cat "$folder/full.txt")" = "ragtop_bench: $folder/full/journal: cannot be written: File too large" ] ||
    fail "a full disk: says $(cat "$folder/full.txt")"

# So do runs that are killed at random moments, one after the other, over scenes that slide, roll and spin. Of one engine
# they take a second or two, so that they are killed at the end as well as at the beginning.
few=ragtop
"$program" chart --list --engines ode >"$folder/out" 2>&1 && few=ode
set -- chart --quick --scenes stopping,rolling,handle --engines $few --repeats 1
"$program" "$@" --out "$folder/whole" >"$folder/out" 2>&1 || true
without_times "$folder/whole/chart.csv" >"$folder/a"
for run in $(seq 20); do
    "$program" "$@" --resume --out "$folder/killed" >"$folder/out" 2>&1 &
    sleep "$(awk -v seed="$$$run" 'BEGIN { srand(seed); print 0.01 + 0.4 * rand() }')"
    kill -KILL $! 2>/dev/null || true
    wait $! 2>/dev/null || true
done
"$program" "$@" --resume --out "$folder/killed" >"$folder/out" 2>&1 || true
without_times "$folder/killed/chart.csv" >"$folder/b"
cmp "$folder/a" "$folder/b" || fail "a sweep that was killed ends otherwise"

# Nor does it matter how many processes measure.
if command -v mpirun >/dev/null; then
    export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
    for ranks in 1 2 4; do
        TMPDIR=$folder mpirun --oversubscribe -n $ranks "$program" "$@" --out "$folder/ranks$ranks" >"$folder/out" 2>&1 </dev/null || true
        if grep -q 'built without Open MPI' "$folder/out"; then break; fi
        without_times "$folder/ranks$ranks/chart.csv" >"$folder/b"
        cmp "$folder/a" "$folder/b" || fail "$ranks ranks end otherwise"
    done
fi

head -n 5 "$csv" >"$folder/short.csv"
refuses "is cut off after 4 of" --draw "$folder/short.csv"
refuses "$folder/first/chart.csv: has no point rolling/" --quick --scenes rolling --engines ragtop --repeats 1 \
    --renew "$folder/first/chart.csv" --out "$folder/other"
"$program" chart --losses "$csv" | grep -q '^| Scene | Engine |' || fail "no table of losses"

if [ -f "$tree/build/page/chart.html" ]; then
    page=$folder/first/chart.html
    [ "$(wc -c <"$page")" -le 3000000 ] || fail "the page has more than 3 MB"
    if grep -qE '(src|href)="(https?:)?//' "$page"; then fail "the page asks the network"; fi
fi

# Programs that speak the protocol, each with a fault of its own: a line tells it, and the sweep goes on.
cat >"$folder/engine" <<'END'
body='[0,0.5,0,0,0,0,1,0,0,0,0,0,0]'
while read -r line; do
    case "$1:$line" in
    mute:*) exit 3 ;;
    *'"hello"'*) echo "{\"name\":\"$1\"}" ;;
    few:*) echo "{\"bodies\":[$body]}" ;;
    refuses:*) echo '{"unsupported":"scenes"}' ;;
    still:* | *'"scene"'*) echo "{\"bodies\":[$body,$body],\"cpu_ms\":0.01}" ;;
    nan:*) echo "{\"bodies\":[$body,[null,0,0,0,0,0,1,0,0,0,0,0,0]]}" ;;
    late:*) sleep 60 ;;
    dies:*) exit 1 ;;
    babbles:*) echo 'what?' ;;
    esac
done
END
# told <name> <words>: what a sweep of the engine says.
told() {
    "$program" chart --scenes stopping --engines "$ours" --quick --repeats 1 --patience 1 --out "$folder/third" \
        --engine-command "sh $folder/engine $1" >"$folder/out" 2>&1 || [ ! -f "$tree/build/page/chart.html" ] ||
        fail "the sweep with an engine that is $1 ends: $(tail -n 1 "$folder/out")"
    grep "^stopping/$1@60x1i0 " "$folder/out" | grep -qF -- "$2" || fail "$1: does not say \"$2\" but $(cat "$folder/out")"
    grep -q '^stopping/ode-exact@60x1i0 \|^stopping/ragtop@60x4i0 ' "$folder/out" || fail "$1: the sweep does not go on"
}
ours=ragtop
"$program" chart --list --engines ode-exact >"$folder/out" 2>&1 && ours=ode-exact
told few 'fails: the program tells of 1 bodies, must be of 2'
told nan 'fails: body 1 is nowhere after'
told dies 'fails: the program has ended'
told babbles 'fails: the program answers what is no object: what?'
told refuses 'skipped: "scenes"'
told late 'fails: the program does not answer within 1 s'
told still 'error'
refuses "--engine-command sh $folder/engine mute: the program has ended" --engine-command "sh $folder/engine mute"
refuses '--engine-command sh '"$folder"'/engine ragtop: name is "ragtop", must be none that is known' \
    --engine-command "sh $folder/engine ragtop"
if command -v node >/dev/null; then
    for scene in stopping friction-slides; do
        "$program" chart --point "$scene/example@240x1i10" --scenes "$scene" --repeats 1 \
            --engine-command "node $tree/bench/chart/example_engine.mjs" >"$folder/out"
        awk -F, 'END { exit !($21 != "" && $21 < 0.01) }' "$folder/out" || fail "the example errs in $scene: $(cat "$folder/out")"
    done
fi

# keeps <mark> <source> <command>...: the documentation has at a mark what a command tells of a source.
keeps() {
    awk -v mark="<!-- $1 -->" '$0 == mark { on = 1; next } /^<!-- end -->$/ { on = 0 } on' "$tree/docs/chart.md" >"$folder/told"
    source=$2
    shift 2
    { echo; "$program" "$@" "$tree/$source"; echo; } >"$folder/table"
    cmp "$folder/told" "$folder/table" ||
        fail "docs/chart.md: what stands between its marks is not of $source; scripts/chart.sh --tables renews it"
}
keeps losses bench/results/chart.csv chart --losses
keeps findings bench/results/chart.csv chart --findings
if grep -q '| *|$' "$folder/told"; then fail "docs/chart.md: a cell of the findings is empty"; fi
"$program" chart --losses "$tree/bench/results/chart.csv" >"$folder/table"
if grep -q '|  |$' "$folder/table"; then fail "a loss has no reason: $(grep '|  |$' "$folder/table")"; fi
keeps economy bench/results/economy.json economy --table
if "$program" economy --table "$tree/LICENSE" >"$folder/out" 2>&1; then fail "economy: takes a licence for a result"; fi
grep -q "LICENSE: " "$folder/out" || fail "economy: does not say which file is wrong: $(cat "$folder/out")"
