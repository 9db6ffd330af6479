# Reports functions longer than 80 lines, in core 60 where no comment right above says why ("Long: ..."). A brace opens a function when the declaration before it has a parameter
# list and is none of a class, an enumeration or a namespace; braces inside functions only nest.

function reset() {
    depth = in_function = in_comment = in_raw = 0
    declaration = ""
}

# Drops comments and the contents of literals, whose braces mean nothing.
function code_of(line, at) {
    if (in_raw) {
        if (!(at = index(line, raw_end))) return ""
        line = substr(line, at + length(raw_end))
        in_raw = 0
    }
    if (in_comment) {
        if (!(at = index(line, "*/"))) return ""
        line = substr(line, at + 2)
        in_comment = 0
    }
    if (match(line, /R"[^(" ]*\(/)) {
        raw_end = ")" substr(line, RSTART + 2, RLENGTH - 3) "\""
        at = index(substr(line, RSTART + RLENGTH), raw_end)
        if (!at) {
            in_raw = 1
            return substr(line, 1, RSTART - 1)
        }
        line = substr(line, 1, RSTART - 1) substr(line, RSTART + RLENGTH + at + length(raw_end) - 1)
    }
    gsub(/\\./, "", line)
    gsub(/"[^"]*"/, "\"\"", line)
    gsub(/'[{}();"]'/, "", line)
    gsub(/\/\*[^*]*\*\//, "", line)
    sub(/\/\/.*/, "", line)
    if ((at = index(line, "/*"))) {
        in_comment = 1
        line = substr(line, 1, at - 1)
    }
    return line
}

FNR == 1 { reset() }

/^[ \t]*#/ { next }

# A reason holds for what follows it, up to the next blank line.
/^[ \t]*\/\/.*Long: / { reason = 1 }
/^[ \t]*$/ { if (!in_function) reason = 0 }

{
    line = code_of($0)
    for (i = 1; i <= length(line); ++i) {
        c = substr(line, i, 1)
        if (c == "{") {
            ++depth
            if (!in_function && declaration ~ /\)/ &&
                declaration !~ /(^|[^A-Za-z_])(namespace|class|struct|union|enum)[^A-Za-z_]/) {
                in_function = depth
                first = FNR
            }
            declaration = ""
        } else if (c == "}") {
            if (in_function == depth) {
                if (FNR - first + 1 > (FILENAME ~ /(^|\/)core\// && !reason ? 60 : 80)) {
                    print FILENAME ":" first ": a function of " FNR - first + 1 " lines"
                    failed = 1
                }
                in_function = reason = 0
            }
            --depth
            declaration = ""
        } else if (c == ";") {
            declaration = ""
        } else {
            declaration = declaration c
        }
    }
    declaration = declaration " "
}

END { exit failed }
