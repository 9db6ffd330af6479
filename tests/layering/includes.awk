# Checks the includes of one module's files. Given: module; public, private (newline-separated names that it may
# include as ragtop/... and as its own files).

BEGIN {
    count = split(public, names, "\n")
    for (i = 1; i <= count; ++i) is_public[names[i]] = 1
    count = split(private, names, "\n")
    for (i = 1; i <= count; ++i) is_private[names[i]] = 1
}

function complain(what) {
    print FILENAME ":" FNR ": " what
    failed = 1
}

# A name in quotes is looked up beside the including file first, then in src/.
function own_file(name, directory) {
    directory = FILENAME
    sub("^" module "/src/", "", directory)
    if (!sub("/[^/]*$", "/", directory)) directory = ""
    return (directory name in is_private) || (name in is_private)
}

FNR == 1 {
    header = FILENAME ~ /\/include\//
    once = 0
}

header && /^[ \t]*#[ \t]*pragma[ \t]+once/ { once = 1 }

header && /^[ \t]*#[ \t]*define/ { complain("a macro in a public header") }

header && /^[ \t]*(namespace|class|struct|#[ \t]*include)/ && !once {
    complain("no #pragma once before the first declaration")
    once = 1
}

/^[ \t]*#[ \t]*include/ {
    angled = match($0, /<[^>]*>/)
    if (!angled && !match($0, /"[^"]*"/)) next
    name = substr($0, RSTART + 1, RLENGTH - 2)
    if (name ~ /^ragtop\//) {
        if (!(name in is_public)) complain(name " is no public header of a module that " module " may use")
    } else if (header) {
        eigen = FILENAME ~ /\/include\/ragtop\/eigen\.h$/ && name ~ /^Eigen\//
        if (!eigen && (!angled || name ~ /[.\/]/)) complain("a public header includes " name)
    } else if (!angled && !own_file(name)) {
        complain(name " is no file of " module)
    }
}

END { exit failed }
