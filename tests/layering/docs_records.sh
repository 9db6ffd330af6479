#!/bin/sh
# docs_records.sh <source tree>: decision records and the changelog keep their form.
#   A record in docs/adr has at most 60 lines, a status, context, decision, consequences, one table and its proof; the tests
#   that records name exist, and so do the records that source comments name, and the files and
#   names of the code that pages name.
#   CHANGELOG.md has at most 120 lines, docs/step.md at most 250.
set -eu
export LC_ALL=C
cd "$1"
status=0
complain() {
    echo "$1"
    status=1
}
atMost() {
    lines=$(wc -l <"$1")
    [ "$lines" -le "$2" ] || complain "$1: $lines lines, more than $2"
}

atMost CHANGELOG.md 120
atMost docs/step.md 250
tests=$(mktemp)
sources=$(mktemp)
words=$(mktemp)
trap 'rm -f "$tests" "$sources" "$words"' EXIT
grep -rhoE '^(TEST|TEST_F|TEST_P|TYPED_TEST)\([A-Za-z0-9]+, [A-Za-z0-9]+' tests --include='*.cpp' |
    sed 's/^[A-Z_]*(//; s/, /./' | sort -u >"$tests"
for record in docs/adr/[0-9]*.md; do
    atMost "$record" 60
    grep -q '^Status: ' "$record" || complain "$record: no status"
    for part in Context Decision Consequences Proof; do
        grep -q "^## $part\$" "$record" || complain "$record: no section $part"
    done
    tables=$(grep -cE '^ *\|[-|: ]+\|$' "$record" || true)
    [ "$tables" = 1 ] || complain "$record: $tables tables, not one"
    grep -qF "($(basename "$record"))" docs/adr/README.md || complain "docs/adr/README.md: does not name $record"
    named=$(sed -n '/^## Proof/,$p' "$record" | grep -oE '`[A-Z][A-Za-z0-9]+\.[A-Z][A-Za-z0-9]+`' | tr -d '`' | sort -u)
    for name in $(echo "$named" | comm -23 - "$tests"); do complain "$record: no test $name"; done
done
# Files that pages name in code marks, by the end of their path.
find core vehicles ragdolls assets demos bench tests scripts page -name node_modules -prune -o -type f -print 2>/dev/null |
    sed 's|^|/|' >"$sources"
for page in docs/adr/*.md docs/measurements/*.md docs/step.md docs/architecture.md docs/reading.md docs/threading.md docs/joints.md; do
    for name in $(grep -oE '`[A-Za-z0-9_./]+\.(h|cpp|inl|sh|py)`' "$page" | tr -d '`' | sort -u |
        awk 'NR == FNR { all = all $0 "\n"; next } !index(all, "/" $0)' "$sources" -); do
        complain "$page: no file $name"
    done
done
# Names in camel case that pages name in code marks occur in the sources.
find core vehicles ragdolls assets demos bench tests page -name node_modules -prune -o -type f \( -name '*.h' -o -name '*.cpp' -o -name '*.inl' -o -name '*.mjs' \
    -o -name '*.js' \) -exec cat {} + | grep -oE '[A-Za-z_][A-Za-z0-9_]*' | sort -u >"$words"
for page in docs/adr/*.md docs/step.md docs/architecture.md docs/reading.md docs/notation.md docs/threading.md docs/state.md docs/joints.md; do
    named=$(sed '/^## Words/,/^## /d' "$page" | grep -oE '`[A-Za-z_][A-Za-z0-9_:]*(\(\))?`' | tr -d '`()' | sed 's/.*:://' | grep -E '[a-z][A-Z]' | sort -u)
    for name in $(echo "$named" | comm -23 - "$words"); do complain "$page: nothing is called $name"; done
done
for number in $(grep -rhoE 'docs/adr/[0-9]{4}' core vehicles ragdolls assets/include assets/src demos bench tests \
    --include='*.h' --include='*.cpp' --include='*.inl' | sed 's|.*/||' | sort -u); do
    ls "docs/adr/$number"-*.md >/dev/null 2>&1 || complain "a comment names docs/adr/$number, which is no record"
done
exit $status
