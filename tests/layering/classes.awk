# classes.awk: -v ceilings=<file> sources...: no class has more public member functions or fields than the limits, and
# those that are known to exceed them exactly as many as the ceilings file says: "<class> <functions> <fields>" per line.
# A class that has come down asks for a lower ceiling, so that the file only shrinks.
BEGIN {
    mostFunctions = 30
    mostFields = 25
    mostOfWorld = 15  # parts of the implementation of World
    while ((getline line < ceilings) > 0) {
        if (line ~ /^#/ || line == "") continue
        split(line, part, " ")
        allowedFunctions[part[1]] = part[2]
        allowedFields[part[1]] = part[3]
    }
}

function finish(name, functions, fields,    f, d) {
    if (name == "") return
    f = name in allowedFunctions ? allowedFunctions[name] : mostFunctions
    d = name in allowedFields ? allowedFields[name] : name == "WorldImpl" ? mostOfWorld : mostFields
    if (functions > f) { failed = 1; print FILENAME ": " name " has " functions " public member functions, may have " f }
    if (fields > d) { failed = 1; print FILENAME ": " name " has " fields " fields, may have " d }
    if (name in allowedFunctions) {
        seen[name] = 1
        if ((f > mostFunctions && functions < f) || (d > mostFields && fields < d)) {
            failed = 1
            print FILENAME ": " name " has come down to " functions " public member functions and " fields \
                  " fields: say so in " ceilings
        }
    }
}

# One statement at the depth of a class: a function when a parenthesis opens before any value or body. Its fields are
# what commas outside of all brackets and values divide.
function count(text,    head) {
    gsub(/^[ \t]+/, "", text)
    if (text == "" || text ~ /^(public|private|protected):/ || text ~ /^(using|friend|static_assert|enum|struct|class|union|template <.*> *(struct|class))/) return
    if (text ~ /^(static |inline )*constexpr/ && text !~ /\(/) return
    if (text ~ /^static / && text !~ /\(/) return
    gsub(/alignas\([^)]*\) */, "", text)
    while (gsub(/<[^<>()]*>/, "", text)) {}
    head = text
    sub(/[={].*/, "", head)
    if (head ~ /\(/ || text ~ /^(explicit|~|operator)/) {
        if (!hidden[depth]) functions[depth]++
        return
    }
    while (gsub(/\([^()]*\)|\{[^{}]*\}|\[[^][]*\]/, "", text)) {}
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
                hidden[depth] = kind ~ /^(template <[^{]*> *)?class/
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
        } else if (c == ":" && text ~ /^[ \t]*(public|private|protected)$/) {
            hidden[depth] = text !~ /public/
            text = ""
        } else text = text c
    }
    text = text " "
}

END {
    for (known in allowedFunctions)
        if (!(known in seen)) { failed = 1; print ceilings ": " known " is no class any more" }
    exit failed
}
