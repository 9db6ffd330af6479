#!/bin/sh
# run.sh find_package|add_subdirectory|pkg_config|readme|serve <source tree> <build tree> <C++ compiler> <build type>
#
# Builds a program on Ragtop the way a consumer would, runs it, and looks for the recording it writes.
#   find_package      against an installation, with CMake
#   pkg_config        against an installation, with pkg-config and the compiler alone
#   add_subdirectory  from Ragtop's sources
#   readme            the first C++ block of README.md, against the build tree
#   serve             the first C++ block of docs/serve.md, against an installation; it must serve until it is ended
set -eu
way=$1 source=$2 build=$3 compiler=$4 build_type=$5

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
prefix=$work/prefix

install_ragtop() {
    cmake --install "$build" --prefix "$prefix" >"$work/install.log" || {
        cat "$work/install.log"
        exit 1
    }
}

build_consumer() {
    cmake -G Ninja -S "$source/tests/consumer" -B "$work/build" \
        -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$build_type" "$@"
    cmake --build "$work/build" --target consumer --parallel 2
    program=$work/build/consumer
}

first_block() { awk '/^```/ { if (inside) exit; inside = /^```cpp/; next } inside' "$1"; }

case $way in
find_package)
    install_ragtop
    build_consumer -DCMAKE_PREFIX_PATH="$prefix"
    ;;
pkg_config)
    install_ragtop
    PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name ragtop.pc)")
    export PKG_CONFIG_PATH
    # Unquoted: pkg-config answers with a list of arguments.
    "$compiler" -std=c++20 -O2 "$source/tests/consumer/main.cpp" -o "$work/consumer" \
        $(pkg-config --cflags --static --libs ragtop) -Wl,-rpath,"$(pkg-config --variable=libdir ragtop)"
    program=$work/consumer
    ;;
add_subdirectory)
    build_consumer -DRAGTOP_SOURCE="$source"
    ;;
readme)
    first_block "$source/README.md" >"$work/hello.cpp"
    build_consumer -Dragtop_DIR="$build" -DCONSUMER_SOURCE="$work/hello.cpp"
    ;;
serve)
    install_ragtop
    first_block "$source/docs/serve.md" | sed 's/options{.name/options{.port = 0, .name/' >"$work/wind.cpp"
    build_consumer -DCMAKE_PREFIX_PATH="$prefix" -DCONSUMER_SOURCE="$work/wind.cpp" -DCONSUMER_LIBRARY=ragtop::serve
    "$program" >"$work/output" &
    server=$!
    tries=0
    until grep -q 'http://127.0.0.1:' "$work/output"; do
        tries=$((tries + 1))
        [ $tries -lt 100 ] && kill -0 $server || { cat "$work/output"; exit 1; }
        sleep 0.1
    done
    cat "$work/output"
    kill -TERM $server
    wait $server || true
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
