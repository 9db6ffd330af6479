#!/bin/sh
# five_commands.sh <program> <source tree>: runs the commands of docs/characters.md on rigs of the tests. Those that judge a
# body may find it wanting, which is 1; all others end with 0.
set -eu
program=$1
source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp "$source/tests/data/rigs/human.gltf" "$folder/hero.gltf"
cp "$source/tests/data/rigs/human_motion_centimetres.bvh" "$folder/walk.bvh"
cd "$folder"
sed -n '/^```sh$/,/^```$/p' "$source/docs/characters.md" | grep '^ragtop ' > commands
[ "$(wc -l < commands)" -eq 5 ] || { echo "docs/characters.md has not five commands"; exit 1; }
while read -r _ arguments; do
    # shellcheck disable=SC2086
    "$program" $arguments > output 2>&1 < /dev/null && status=0 || status=$?
    case $arguments in *--test*) most=1 ;; *) most=0 ;; esac
    [ "$status" -le "$most" ] || { echo "ends with $status: ragtop $arguments"; cat output; exit 1; }
done < commands
for file in hero.ragdoll.json hero.fitted.ragdoll.json hero.ragtop; do
    [ -s "$file" ] || { echo "no $file was written"; exit 1; }
done
