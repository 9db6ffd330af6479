# folders.awk docs/architecture.md core/src files...: a folder of core includes those that its row of the table names, and
# no others; every folder has a row, and what it includes stands above it, but for single files that a row names.
FNR == 1 { ++file }

file == 1 && /^\| Folder .*\| Includes/ { table = 1; next }
file == 1 && table && /^\| `/ {
    split($0, cell, "|")
    folder = cell[2]
    gsub(/[` ]/, "", folder)
    row[folder] = ++rows
    count = split(cell[4], names, ",")
    for (i = 1; i <= count; ++i) {
        gsub(/ /, "", names[i])
        if (names[i] == "") continue
        allowed[folder, names[i]] = 1
        if (names[i] !~ /\// && !(names[i] in row)) { failed = 1; print FILENAME ": " folder " includes " names[i] ", which does not stand above it" }
    }
    next
}
file == 1 && table && !/^\|/ { table = 0 }

file > 1 && FNR == 1 {
    own = FILENAME
    sub(/.*core\/src\//, "", own)
    sub(/\/.*/, "", own)
    if (!(own in row)) { failed = 1; print FILENAME ": the folder " own " is not in the table of docs/architecture.md" }
    lines[FILENAME] = 0
}
file > 1 { ++lines[FILENAME] }
file > 1 && /^[ \t]*#[ \t]*include[ \t]*"[a-z]+\// {
    name = $0
    sub(/^[^"]*"/, "", name)
    sub(/\/.*/, "", name)
    if (name == "ragtop" || name == own) next
    file_name = $0
    sub(/^[^"]*"/, "", file_name)
    sub(/".*/, "", file_name)
    if ((own, file_name) in allowed) { used[own, file_name] = 1; next }
    used[own, name] = 1
    if (!((own, name) in allowed)) {
        failed = 1
        print FILENAME ":" FNR ": " own " may not include " name " (docs/architecture.md)"
    }
}

END {
    for (pair in allowed)
        if (!(pair in used)) {
            split(pair, both, SUBSEP)
            failed = 1
            print "docs/architecture.md: " both[1] " does not include " both[2]
        }
    # Headers of systems tell all in one look.
    for (name in lines)
        if (name ~ /core\/src\/(model|contacts|islands|continuous|events)\/.*\.h$/ && lines[name] > 150) {
            failed = 1
            print name ": the header of a system has " lines[name] " lines, more than 150"
        }
    exit failed
}
