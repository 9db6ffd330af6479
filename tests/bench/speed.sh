#!/bin/sh
# What `ragtop_bench speed` promises to those who read its output; its times are not looked at.
# Usage: speed.sh <ragtop_bench>
set -eu
program=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

fail() {
    echo "speed: $1" >&2
    exit 1
}

if "$program" speed --scene nonsense >"$folder/out" 2>&1; then fail "a scene that is none is accepted"; fi
grep -q '"nonsense" is no scene, must be one of pyramid, brick_house_settle' "$folder/out" ||
    fail "the error does not name the scene and the ones there are: $(cat "$folder/out")"

"$program" speed --scene pyramid --engine ragtop --threads 1,2 --runs 1 --json "$folder/first.json" >/dev/null
for key in scene threads lanes ms bullet_ms ratio stages pen_p99_m pen_max_m joint_gap_max_m moved_max_m solver_mix \
    residual bytes allocations; do
    [ "$(grep -c "^    \"$key\": " "$folder/first.json")" -eq 2 ] || fail "not every row has $key"
done
[ "$(grep -c '^    "' "$folder/first.json")" -eq 30 ] || fail "a row has other keys"
[ "$(grep '"moved_max_m"' "$folder/first.json" | sort -u | wc -l)" -eq 1 ] || fail "threads change the result"

"$program" speed --history "$folder" | grep -q '^| pyramid | 2 | – |$' || fail "the history lacks what was kept"
