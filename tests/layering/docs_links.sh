#!/bin/sh
# docs_links.sh <source tree>: every relative link in the README and the documentation leads to a file.
set -eu
cd "$1"
status=0
count=0
for page in README.md CHANGELOG.md docs/*.md docs/*/*.md; do
    folder=$(dirname "$page")
    for link in $(sed 's/`[^`]*`//g' "$page" | grep -oE '\]\([^)[:space:]]+\)' | sed 's/^](//; s/)$//; s/#.*//'); do
        case $link in
        *://*) continue ;;
        esac
        count=$((count + 1))
        [ -e "$folder/$link" ] || {
            echo "$page: no such file: $link"
            status=1
        }
    done
done
[ $status -ne 0 ] || echo "$count links lead somewhere"
exit $status
