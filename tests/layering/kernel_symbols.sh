#!/bin/sh
# kernel_symbols.sh <nm> <core's library>: the objects compiled for optional instruction sets must not define weak
# functions. The linker keeps any one copy of an inline function; were it theirs, machines without those
# instructions would crash in code that has nothing to do with the kernels.
set -eu
"$1" -A -C --defined-only "$2" | awk '
    /_avx(2|2_lanes16|512)\.cpp\.o:/ && / W / { print; failed = 1 }
    END {
        if (failed) print "weak functions in kernels (above): force them inline or give them internal linkage"
        exit failed
    }'
