#!/usr/bin/env bash
# Builds the C++ program of tools/docs/runtime.md against the installed package, and compares what it draws into its own
# EGL context with prt relight, byte by byte. Exit 77 where EGL cannot be had.
#   check_own_context.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cmake --install "$build" --prefix "$folder/prefix" >/dev/null
prt=$folder/prefix/bin/prt
cd "$folder"
printf '%s\n' 'v -1 0 -1' 'v 1 0 -1' 'v 1 0 1' 'v -1 0 1' 'v -1 1 -1' 'v 1 1 -1' 'v 1 1 1' 'v -1 1 1' \
    'f 4 3 2 1' 'f 1 2 6 5' 'f 2 3 7 6' 'f 3 4 8 7' 'f 4 1 5 8' >box.obj
"$prt" precompute box.obj -o box.prt --texels 64 --rays 128 --order 4 --quiet >/dev/null
"$prt" compress box.prt --components 8 --quiet >/dev/null

sed -n '/^```cpp$/,/^```$/p' "$source/tools/docs/runtime.md" | sed '1d;$d' >main.cpp
grep -q 'int main' main.cpp
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.24)
project(own_context LANGUAGES CXX)
find_package(prt REQUIRED)
pkg_check_modules(egl REQUIRED IMPORTED_TARGET egl)
add_executable(own_context main.cpp)
target_link_libraries(own_context PRIVATE prt::compress prt::runtime PkgConfig::egl)
END
cmake -S . -B build -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$folder/prefix" >configure.log 2>&1 ||
    { cat configure.log; exit 1; }
cmake --build build
build/own_context || { status=$?; echo "no EGL, or the program failed ($status)"; exit $status; }
"$prt" relight box.prt --env sky:clear:0.7 --env sky:sunset:0.3 --rotate 28 --technique pca --context egl \
    --eye 1,3,2 --target 0,0.5,0 --fov 45 --size 320x200 --no-background -o relight.exr --quiet
cmp own.exr relight.exr
echo "the program draws what prt relight draws"
