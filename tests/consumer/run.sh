#!/bin/sh
# run.sh <way> <source tree> <build tree> <C++ compiler> <build type>
#
# Uses Ragtop the way a stranger would. Against an installation that has been moved, and that the sources cannot help:
#   install       makes that installation, which the next five use, and lists, runs and serves with its program
#   remove        takes it away
#   find_package  builds a program with CMake
#   pkg_config    builds it with pkg-config and the compiler alone
#   cooked        cooks a mesh with the program, and builds what loads it where there are no importers
#   serve         builds the first C++ block of docs/serve.md; it must serve until it is ended
# And without one:
#   fetch_content builds programs with the sources of core, and of all modules, as a part of them
#   readme        builds the first C++ block of README.md, against the build tree
set -eu
way=$1 source=$2 build=$3 compiler=$4 build_type=$5

installed=$build/tests/installed
prefix=$installed/moved
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
    echo "$*" >&2
    exit 1
}

configure_consumer() {
    cmake -G Ninja -S "$source/tests/consumer" -B "$work/build" \
        -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$build_type" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "$@"
}

build_consumer() {
    configure_consumer "$@"
    cmake --build "$work/build" --target consumer --parallel 2
    program=$work/build/consumer
}

# cached <variable>: its value in the build tree.
cached() { sed -n "s/^$1:[A-Z]*=//p" "$build/CMakeCache.txt"; }

# commands <build tree>: what compiles Ragtop's sources there, by the compiler itself.
commands() {
    sed -n "s|^ *\"command\": \".*\($compiler .*\)\",\$|\1|p" "$1/compile_commands.json" |
        grep -v CMakeFiles/consumer.dir | sed -e "s|$1/||g" -e 's|_deps/ragtop-build/||g' -e 's/ -Werror / /' | sort
}

# build_as_a_part <cmake option>...: builds the program with Ragtop's sources as a part of it. A command that compiles the
# same source the same way makes the same object: where all are those of the build tree, but for its warnings as errors,
# its libraries are what they would make in some minutes more.
build_as_a_part() {
    rm -rf "$work/build"
    configure_consumer "$@"
    ! grep -e -Werror "$work/build/compile_commands.json" || fail "warnings are errors in other people's builds"
    commands "$work/build" >"$work/there"
    grep -q core/src "$work/there" || fail "core's sources are none of its"
    commands "$build" | comm -13 - "$work/there" >"$work/others"
    [ ! -s "$work/others" ] || fail "compiled otherwise than in $build: $(cat "$work/others")"
    part=$work/build/_deps/ragtop-build
    for folder in core assets vehicles ragdolls cooked; do
        [ -d "$part/$folder" ] || continue
        joined=CMakeFiles/ragtop_$folder.dir/Unity
        # Not the other way round: a build tree keeps units of before.
        for unit in "$part/$folder/$joined"/*.cxx; do
            [ ! -e "$unit" ] || cmp "$unit" "$build/$folder/$joined/${unit##*/}"
        done
        cp "$build/$folder"/libragtop_* "$part/$folder"
    done
    ninja -C "$work/build" -t commands consumer | grep -F CMakeFiles/consumer.dir >"$work/own"
    (cd "$work/build" && sh -e "$work/own")
    program=$work/build/consumer
}

# Starts a server in the background and waits for its address.
start_serving() {
    "$@" >"$work/output" 2>&1 &
    server=$!
    trap 'kill -KILL $server 2>"$work/killed" || true; rm -rf "$work"' EXIT
    tries=0
    until grep -q 'http://127.0.0.1:' "$work/output"; do
        tries=$((tries + 1))
        [ $tries -lt 600 ] && kill -0 $server || fail "does not serve: $(cat "$work/output")"
        sleep 0.1
    done
    address=$(sed -n 's|.*\(http://127.0.0.1:[0-9]*/\).*|\1|p' "$work/output")
}

download() { # <url> <file>
    printf 'file(DOWNLOAD %s %s STATUS status)\nlist(GET status 0 code)\nif(code)\nmessage(FATAL_ERROR "${status}")\nendif()\n' \
        "$1" "$2" >"$work/download.cmake"
    cmake -P "$work/download.cmake"
}

end_serving() {
    kill -TERM $server
    wait $server || true
}

first_block() { awk '/^```/ { if (inside) exit; inside = /^```cpp/; next } inside' "$1"; }

# hide <path>: what is installed finds nothing there any more: the path becomes another one of its length.
hide() {
    find "$prefix" -type f -exec grep -lF "$1" {} + >"$work/naming" || true
    while read -r file; do
        LC_ALL=C sed -i "s|$1|$(printf %s "$1" | sed 's|[^/]|_|g')|g" "$file"
    done <"$work/naming"
}

install_and_move() {
    rm -rf "$installed"
    mkdir -p "$installed"
    cmake --install "$build" --prefix "$installed/first" >"$work/install.log" || fail "$(cat "$work/install.log")"
    mv "$installed/first" "$prefix"
    grep -rIlF -e "$source" -e "$build" -e "$installed/first" "$prefix" && fail "these name where they were built"
    hide "$source"
    hide "$build"
    hide "$(cached CMAKE_INSTALL_PREFIX)/share/ragtop"
}

try_program() {
    ragtop=$prefix/bin/ragtop
    [ -x "$ragtop" ] || return 0
    cd "$work"
    scenes=$(ls "$prefix/share/ragtop/scenes" | sed -n 's/\.json$//p')
    [ "$("$ragtop" list | sed 's/ .*//')" = "$scenes" ] || fail "list does not tell of what is installed"
    # A car, a person and an included file.
    "$ragtop" run crash --steps 2 | grep -q '"finite": true' || fail "run does not find what the scene has in it"
    page=$prefix/share/ragtop/page/ragtop.html
    mkdir -p "${page%/*}"
    [ -e "$page" ] || echo '<!doctype html><title>stands in for the page, which is not built</title>' >"$page"
    start_serving "$ragtop" serve tower --port 0
    download "$address" "$work/page.html"
    cmp "$page" "$work/page.html"
    end_serving
    mv "$prefix/share" "$prefix/hidden"
    for command in list 'run tower' 'serve tower --port 0'; do
        status=0
        "$ragtop" $command >"$work/nothing" 2>&1 || status=$?
        [ $status = 2 ] && grep -q "RAGTOP_DATA.*moved/share/ragtop/scenes" "$work/nothing" ||
            fail "$command without data ends with $status: $(cat "$work/nothing")"
    done
    mv "$prefix/hidden" "$prefix/share"
}

case $way in
install)
    install_and_move
    try_program
    exit
    ;;
remove)
    rm -rf "$installed"
    exit
    ;;
find_package)
    build_consumer -DCMAKE_PREFIX_PATH="$prefix"
    RAGTOP_DATA=$(cat "$work/build/data_folder")
    export RAGTOP_DATA
    ;;
pkg_config)
    PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name ragtop.pc)")
    RAGTOP_DATA=$(PKG_CONFIG_PATH=$PKG_CONFIG_PATH pkg-config --variable=datadir ragtop)
    export PKG_CONFIG_PATH RAGTOP_DATA
    # Unquoted: pkg-config answers with a list of arguments.
    "$compiler" -std=c++20 -O2 "$source/tests/consumer/main.cpp" -o "$work/consumer" \
        $(pkg-config --cflags --static --libs ragtop) -Wl,-rpath,"$(pkg-config --variable=libdir ragtop)"
    program=$work/consumer
    ;;
fetch_content)
    set -- -DFETCHCONTENT_SOURCE_DIR_RAGTOP="$source"
    for name in CMAKE_CXX_FLAGS CMAKE_INSTALL_PREFIX RAGTOP_UNITY RAGTOP_WITH_QHULL RAGTOP_WITH_TBB; do
        set -- "$@" "-D$name=$(cached $name)"
    done
    build_as_a_part -DRAGTOP_BUILD_ASSETS=OFF -DCONSUMER_SOURCE="$source/tests/consumer/core.cpp" \
        -DCONSUMER_LIBRARY=ragtop::core "$@"
    "$program"
    build_as_a_part "$@"
    ;;
readme)
    first_block "$source/README.md" >"$work/hello.cpp"
    build_consumer -Dragtop_DIR="$build" -DCONSUMER_SOURCE="$work/hello.cpp"
    ;;
serve)
    first_block "$source/docs/serve.md" | sed 's/options{.name/options{.port = 0, .name/' >"$work/wind.cpp"
    build_consumer -DCMAKE_PREFIX_PATH="$prefix" -DCONSUMER_SOURCE="$work/wind.cpp" -DCONSUMER_LIBRARY=ragtop::serve
    start_serving "$program"
    cat "$work/output"
    end_serving
    exit
    ;;
cooked)
    printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n' >"$work/corner.obj"
    "$prefix/bin/ragtop" cook "$work/corner.obj" --out "$work/corner.ragtop" --pieces 4
    build_consumer -DCMAKE_PREFIX_PATH="$prefix" -DCONSUMER_SOURCE="$source/tests/consumer/cooked.cpp" \
        -DCONSUMER_LIBRARY=ragtop::cooked -DCONSUMER_COMPONENTS=cooked -DCMAKE_DISABLE_FIND_PACKAGE_assimp=ON
    ! grep -i assimp "$work/build/build.ninja" || fail "links assimp"
    "$program" "$work/corner.ragtop"
    exit
    ;;
*)
    echo "unknown way to build: $way" >&2
    exit 2
    ;;
esac

cd "$work"
"$program" >output
cat output
if [ "$way" = readme ]; then
    grep -Eq 'the brick rests at 0\.1[0-9][0-9] m' output
fi
test -s hello.glb
