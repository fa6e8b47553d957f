#!/bin/sh
# Starts a C++ runner, and compiles it first if necessary: sh runners/run.sh nanoflann
# The program is kept in the cache of the user. CXX and CXXFLAGS set the compiler and its flags.
name=$1
here=$(dirname "$0")
case $name in
    nanoflann) header=nanoflann.hpp package=libnanoflann-dev ;;
    cgal) header=CGAL/box_intersection_d.h package=libcgal-dev ;;
    *) printf '{"reply":"unavailable","reason":"there is no runner %s: nanoflann, cgal"}\n' "$name"; exit ;;
esac
compiler=${CXX:-g++}
flags=${CXXFLAGS:--O3 -march=native -DNDEBUG}
cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/contactbench

unavailable() {
    printf '{"reply":"unavailable","reason":"%s: apt-get install g++ %s"}\n' "$1" "$package"
    exit
}

command -v "$compiler" >/dev/null || unavailable "there is no compiler $compiler"
# The name contains a checksum of sources, compiler and flags, so the program is never outdated.
mark=$( { cat "$here/$name.cpp" "$here/runner.hpp"; "$compiler" --version; echo "$flags"; uname -nm; } | cksum | tr ' ' -)
program=$cache/$name-$mark
if [ ! -x "$program" ]; then
    echo "#include <$header>" | "$compiler" -std=c++17 -E -x c++ - >/dev/null 2>&1 || unavailable "the header $header is not installed"
    mkdir -p "$cache" || unavailable "the folder for the program cannot be made"
    # shellcheck disable=SC2086 # flags are words
    "$compiler" -std=c++17 $flags "$here/$name.cpp" -o "$program.$$" >&2 || unavailable "$name.cpp does not compile"
    mv "$program.$$" "$program"
fi
exec "$program"
