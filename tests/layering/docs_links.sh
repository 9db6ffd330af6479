#!/bin/sh
# docs_links.sh <source tree>: every relative link in the README and the documentation leads to a file, and to a heading of it
# where it names one.
set -eu
export LC_ALL=C
cd "$1"
status=0
count=0
# The names that GitHub gives the headings of a page.
headings() {
    sed -n 's/^##* //p' "$1" | tr '[:upper:]' '[:lower:]' | sed 's/`//g; s/[^a-z0-9 _-]//g; s/ /-/g'
}
for page in README.md CHANGELOG.md docs/*.md docs/*/*.md; do
    folder=$(dirname "$page")
    for link in $(sed 's/`[^`]*`//g' "$page" | grep -oE '\]\([^)[:space:]]+\)' | sed 's/^](//; s/)$//'); do
        case $link in
        *://*) continue ;;
        esac
        count=$((count + 1))
        file=${link%%#*}
        target=$folder/$file
        [ -n "$file" ] || target=$page
        if [ ! -e "$target" ]; then
            echo "$page: no such file: $file"
            status=1
            continue
        fi
        case $link in
        *.md\#* | \#*)
            headings "$target" | grep -qx -- "${link#*#}" || {
                echo "$page: no such heading: $link"
                status=1
            }
            ;;
        esac
    done
done
[ $status -ne 0 ] || echo "$count links lead somewhere"
exit $status
