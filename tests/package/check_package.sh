#!/usr/bin/env bash
# Installs the build into a temporary place, then builds and runs the README's C++ example against find_package(prt).
#   check_package.sh BUILD_DIR SOURCE_DIR
set -euo pipefail
build=$1 source=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

cmake --install "$build" --prefix "$folder/prefix" >/dev/null
[[ $("$folder/prefix/bin/prt" --version) == prt\ * ]]

mkdir "$folder/consumer"
cd "$folder/consumer"
sed -n '/^```cpp$/,/^```$/p' "$source/README.md" | sed '1d;$d' >main.cpp
grep -q 'int main' main.cpp
cat >CMakeLists.txt <<'END'
cmake_minimum_required(VERSION 3.24)
project(consumer LANGUAGES CXX)
find_package(prt REQUIRED)
foreach(part base math tables io rays mesh visibility compress runtime reference)
  if(NOT TARGET prt::${part})
    message(FATAL_ERROR "no target prt::${part}")
  endif()
endforeach()
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE prt::visibility)
END
cmake -S . -B build -DCMAKE_PREFIX_PATH="$folder/prefix" >configure.log 2>&1 || { cat configure.log; exit 1; }
cmake --build build
cp "$source/meshes/shapes/sphere.obj" bunny.obj
build/consumer
echo "the README's example runs against the installed package"
