# Compiler settings and the functions every CMakeLists.txt of the project uses: prt_library, prt_test
# and prt_bench.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(PRT_CCACHE ccache)
if(PRT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PRT_CCACHE})
endif()

add_library(prt_settings INTERFACE)
target_compile_options(prt_settings INTERFACE -Wall -Wextra -Wshadow -Wnon-virtual-dtor)
if(PRT_WARNINGS_AS_ERRORS)
  target_compile_options(prt_settings INTERFACE -Werror)
endif()
if(PRT_SANITIZE)
  # Eigen and the standard library are fine; recover = off turns every finding into a failed test.
  target_compile_options(prt_settings INTERFACE -fsanitize=${PRT_SANITIZE} -fno-sanitize-recover=all
                                                -fno-omit-frame-pointer)
  target_link_options(prt_settings INTERFACE -fsanitize=${PRT_SANITIZE})
endif()

# prt_library(<name> SOURCES <cpp>... [DEPS <prt target>...] [LINK <private library>...])
# Makes target prt_<name> with alias prt::<name>. Third-party libraries stay private: no header of ours shows them.
function(prt_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;LINK" ${ARGN})
  add_library(prt_${name} STATIC ${ARG_SOURCES})
  add_library(prt::${name} ALIAS prt_${name})
  set_target_properties(prt_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(prt_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
                                                $<INSTALL_INTERFACE:include/prt>)
  target_compile_features(prt_${name} PUBLIC cxx_std_20)
  target_link_libraries(prt_${name} PRIVATE $<BUILD_INTERFACE:prt_settings> ${ARG_LINK})
  foreach(dep ${ARG_DEPS})
    target_link_libraries(prt_${name} PUBLIC prt_${dep})
  endforeach()
  set_property(GLOBAL APPEND PROPERTY PRT_LIBRARIES prt_${name})
endfunction()

# The headers of all tests, compiled once: they cost ten seconds a target under sanitizers.
function(prt_test_headers)
  if(TARGET test_headers)
    return()
  endif()
  set(source ${CMAKE_BINARY_DIR}/test_headers.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "int main() { return 0; }\n")
  add_executable(test_headers ${source})
  target_link_libraries(test_headers PRIVATE prt_settings GTest::gmock_main)
  target_compile_features(test_headers PRIVATE cxx_std_20)
  target_precompile_headers(test_headers PRIVATE <gmock/gmock.h> <gtest/gtest.h> <vector> <string> <filesystem>)
endfunction()

# prt_test(<folder> <class> SOURCES <cpp>... [DEPS <prt target>...] [LINK <library>...])
# One GoogleTest binary test_<folder>_<class>; its cases appear in ctest as prt.<class>.<folder>.<Suite.Case>.
# Target tests_<class> builds all of a class.
function(prt_test folder class)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS;LINK" ${ARGN})
  set(target test_${folder}_${class})
  add_executable(${target} ${ARG_SOURCES})
  target_link_libraries(${target} PRIVATE prt_settings GTest::gmock_main ${ARG_LINK})
  foreach(dep ${ARG_DEPS})
    target_link_libraries(${target} PRIVATE prt_${dep})
  endforeach()
  target_compile_definitions(${target} PRIVATE PRT_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  prt_test_headers()
  target_precompile_headers(${target} REUSE_FROM test_headers)
  if(NOT TARGET tests_${class})
    add_custom_target(tests_${class})
  endif()
  add_dependencies(tests_${class} ${target})
  gtest_discover_tests(${target} TEST_PREFIX "prt.${class}.${folder}." DISCOVERY_TIMEOUT 120
                       PROPERTIES LABELS "${class}" TIMEOUT 600)
endfunction()

# prt_bench(<folder> SOURCES <cpp>... [DEPS <prt target>...])
# One Google Benchmark binary bench_<folder>, built where PRT_BUILD_BENCH is on; run by hand, never by ctest.
function(prt_bench folder)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPS" ${ARGN})
  if(NOT PRT_BUILD_BENCH OR NOT ARG_SOURCES)
    return()
  endif()
  add_executable(bench_${folder} ${ARG_SOURCES})
  target_link_libraries(bench_${folder} PRIVATE prt_settings benchmark::benchmark_main)
  foreach(dep ${ARG_DEPS})
    target_link_libraries(bench_${folder} PRIVATE prt_${dep})
  endforeach()
endfunction()
