# classes.awk: -v ceilings=<file> headers...: no class has more member functions or fields than the limits, and those that
# are known to exceed them no more than the ceilings file says: "<class> <functions> <fields>" per line.
BEGIN {
    mostFunctions = 30
    mostFields = 25
    while ((getline line < ceilings) > 0) {
        if (line ~ /^#/ || line == "") continue
        split(line, part, " ")
        allowedFunctions[part[1]] = part[2]
        allowedFields[part[1]] = part[3]
    }
}

function finish(name, functions, fields) {
    if (name == "") return
    f = name in allowedFunctions ? allowedFunctions[name] : mostFunctions
    d = name in allowedFields ? allowedFields[name] : mostFields
    if (functions > f) { failed = 1; print FILENAME ": " name " has " functions " member functions, may have " f }
    if (fields > d) { failed = 1; print FILENAME ": " name " has " fields " fields, may have " d }
}

# One statement at the depth of a class: a function when a parenthesis opens before any value or body.
function count(text,    head) {
    gsub(/^[ \t]+/, "", text)
    if (text == "" || text ~ /^(public|private|protected):/ || text ~ /^(using|friend|static_assert|enum|struct|class|union|template <.*> *(struct|class))/) return
    if (text ~ /^(static |inline )*constexpr/ && text !~ /\(/) return
    head = text
    sub(/[={].*/, "", head)
    if (head ~ /\(/ || text ~ /^(explicit|~|operator)/) { functions[depth]++; return }
    while (gsub(/<[^<>]*>/, "", head)) {}
    text = head
    fields[depth] += 1 + gsub(/,/, ",", text)
}

FNR == 1 { depth = 0; text = ""; parens = 0; delete name; }

{
    line = $0
    sub(/\/\/.*/, "", line)
    if (line ~ /^[ \t]*#/) next
    n = length(line)
    for (i = 1; i <= n; ++i) {
        c = substr(line, i, 1)
        if (c == "{") {
            kind = text
            gsub(/^[ \t]+/, "", kind)
            isClass = kind ~ /^(template <[^{]*> *)?(struct|class|union)( alignas\([^)]*\))? [A-Za-z_]+/ && kind !~ /\(.*\) *(const)?( noexcept)?$/
            inClass = depth > 0 && name[depth] != ""
            if (inClass && !isClass) { braces[depth] = text; }
            outer = text
            ++depth
            saved[depth] = outer
            name[depth] = ""
            if (isClass) {
                cls = kind
                sub(/^template <[^{]*> */, "", cls)
                sub(/^(struct|class|union) (alignas\([^)]*\) )?/, "", cls)
                sub(/[^A-Za-z0-9_].*/, "", cls)
                name[depth] = cls
                functions[depth] = fields[depth] = 0
            }
            text = ""
        } else if (c == "}") {
            if (name[depth] != "") finish(name[depth], functions[depth], fields[depth])
            wasClass = name[depth] != ""
            before = saved[depth]
            name[depth] = ""
            --depth
            if (depth > 0 && name[depth] != "" && !wasClass) {
                # A body, or a value in braces that a ; ends.
                if (before ~ /\)[^=]*$/ && before !~ /=[^()]*$/) { count(before); text = "" }
                else text = before "{}"
            } else text = ""
        } else if (c == ";") {
            if (depth > 0 && name[depth] != "") count(text)
            text = ""
        } else if (c == ":" && text ~ /^[ \t]*(public|private|protected)$/) text = ""
        else text = text c
    }
    text = text " "
}

END { exit failed }
