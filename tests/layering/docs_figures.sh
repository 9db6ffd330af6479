#!/bin/sh
# docs_figures.sh <source tree> [<ragtop_bench>]: what the documentation says of the code is so.
#   Tolerances of docs/step.md have their values in the files and constants named there. Where a file is named alone, the
#   number is in it.
#   docs/manoeuvres has a page and a plot for every manoeuvre.
#   docs/architecture.md names every folder of core/src, docs/stability.md every family of the stability suite.
set -eu
cd "$1"
bench=${2:-}

# The table's rows as: value cell | place cell, with powers written as 10^-6.
rows() {
    sed -n '/^## Tolerances/,/^## /p' docs/step.md | grep '^| ' | sed 1d | awk -F'|' '{ print $3 "|" $5 }' |
        sed 's/⁻/^-/g; s/⁰/0/g; s/¹/1/g; s/²/2/g; s/³/3/g; s/⁴/4/g; s/⁵/5/g; s/⁶/6/g; s/⁷/7/g; s/⁸/8/g; s/⁹/9/g; s/·/*/g'
}

check_tolerances() {
    rows | awk -F'|' '
        function complain(text) { print "docs/step.md: " text; failed = 1 }
        # "2*10^-4", "1/32", "0x1p-3", "1.0f / 128", "1e-6f"
        function number(text,   factors, parts, powers, i, n, value) {
            gsub(/[[:space:]f]/, "", text)
            value = 1
            n = split(text, factors, "*")
            for (i = 1; i <= n; ++i) {
                if (split(factors[i], parts, "/") == 2) value *= parts[1] / parts[2]
                else if (split(factors[i], powers, "^") == 2) value *= powers[1] ^ powers[2]
                else value *= factors[i]
            }
            return value
        }
        function valueOf(name, text,   rest) {
            if (!match(text, "[^A-Za-z0-9_]" name " = [^,;]*[,;]")) return ""
            rest = substr(text, RSTART, RLENGTH - 1)
            sub(/.* = /, "", rest)
            return rest
        }
        function contents(file,   line, text) {
            while ((getline line < file) > 0) text = text line "\n"
            close(file)
            return text
        }
        {
            n = split($2, words, "`")
            file = "core/src/" words[2]
            first = 4
            if ($2 ~ /setting/) {
                file = "core/include/ragtop/settings.h"
                first = 2
            }
            text = contents(file)
            if (text == "") complain("no such file: " file)
            values = $1
            for (i = first; i == first || i <= n; i += 2) {
                if (!match(values, /[0-9][0-9.\/*^-]*/)) { complain("too few values: " $1); break }
                told = substr(values, RSTART, RLENGTH)
                values = substr(values, RSTART + RLENGTH)
                if (i > n) {
                    if (index(text, told "f") == 0) complain(told " is not in " file)
                    continue
                }
                has = valueOf(words[i], text)
                if (has == "") complain(words[i] " is not in " file)
                else if ((ratio = number(has) / number(told)) < 0.999999 || ratio > 1.000001)
                    complain(words[i] " is " has " in " file ", not " told)
            }
            ++count
        }
        END {
            if (count < 20) complain("only " count + 0 " tolerances found")
            exit failed
        }'
}

status=0
check_tolerances || status=1
for folder in core/src/*/; do
    name=$(basename "$folder")
    grep -q "^| \`$name\` " docs/architecture.md || {
        echo "docs/architecture.md: does not name core/src/$name"
        status=1
    }
done
for manoeuvre in assets/data/manoeuvres/*.json; do
    name=$(basename "$manoeuvre" .json)
    [ -f "docs/manoeuvres/$name.md" ] && [ -f "docs/manoeuvres/$name.svg" ] || {
        echo "docs/manoeuvres: has no page and plot of $name; scripts/manoeuvres.py writes them"
        status=1
    }
done
if [ -n "$bench" ]; then
    for family in $("$bench" stability --list --long | sed 's|/.*||' | sort -u); do
        grep -q "^| \`$family\` " docs/stability.md || {
            echo "docs/stability.md: does not name the family $family"
            status=1
        }
    done
fi
exit $status
