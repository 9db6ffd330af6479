#!/bin/sh
# What `ragtop_bench speed` promises to those who read its output; its times are not looked at.
# Usage: speed.sh <ragtop_bench> <source tree>
set -eu
program=$1
tree=$2
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
for key in scene threads lanes runs ms bullet_ms worst_ms bullet_worst_ms ratio ratio_lower ratio_upper ratio_confidence \
    stages pen_p99_m pen_max_m below_mesh_m joint_gap_max_m moved_max_m bullet_pen_p99_m bullet_pen_max_m \
    bullet_below_mesh_m bullet_joint_gap_max_m bullet_moved_max_m solver_mix residual bytes allocations; do
    [ "$(grep -c "^    \"$key\": " "$folder/first.json")" -eq 2 ] || fail "not every row has $key"
done
[ "$(grep -c '^    "' "$folder/first.json")" -eq 54 ] || fail "a row has other keys"
[ "$(grep '"moved_max_m"' "$folder/first.json" | sort -u | wc -l)" -eq 1 ] || fail "threads change the result"
for key in joint_gap_max_m below_mesh_m bullet_moved_max_m bullet_ms ratio; do
    [ "$(grep -c "\"$key\": null" "$folder/first.json")" -eq 2 ] || fail "$key is measured of nothing"
done

"$program" speed --history "$folder" | grep -q '^| pyramid | 2 | – |$' || fail "the history lacks what was kept"
"$program" speed --newest "$folder" | grep -q '^| pyramid | 2 | .* | – / – |' || fail "the table lacks what was kept"

# The documentation has the tables of what is kept.
keeps() {
    sed -n "/^<!-- $1 -->\$/,/^<!-- end -->\$/p" "$tree/docs/speed.md" | sed '1d;$d' >"$folder/told"
    { echo; "$program" speed "$2" "$tree/bench/results/speed"; echo; } >"$folder/table"
    cmp "$folder/told" "$folder/table" || fail "docs/speed.md: $1 are not those of bench/results/speed"
}
keeps "kept results" --history
keeps "newest result" --newest

# Bullet's quality stands beside ours, of what the scene has: no joints and no mesh, but what moves.
"$program" speed --scene pyramid_nudged --engine bullet --runs 1 --json "$folder/second.json" >/dev/null
if grep -q '"bullet_ms": null' "$folder/second.json"; then exit 0; fi  # built without Bullet
grep -q '"bullet_moved_max_m": [0-9]' "$folder/second.json" || fail "Bullet's quality is dropped"
for key in ms lanes moved_max_m bytes allocations stages bullet_joint_gap_max_m; do
    grep -q "\"$key\": null" "$folder/second.json" || fail "$key is no null where nothing is measured"
done
