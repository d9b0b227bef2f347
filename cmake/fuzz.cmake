# Finds the fuzz targets: every tests/fuzz/targets/<name>.cpp defines `void <name>(Input)`. Adding one edits no list.
file(GLOB fuzz_target_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/fuzz/targets/*.cpp)

# The table of them, for the test that replays their corpora.
function(vkopple_register_fuzz_targets target)
  set(declarations "")
  set(rows "")
  foreach(source IN LISTS fuzz_target_sources)
    get_filename_component(name ${source} NAME_WE)
    string(APPEND declarations "void ${name}(Input input);\n")
    string(APPEND rows "{\"${name}\", ${name}}, ")
  endforeach()
  set(registry ${CMAKE_BINARY_DIR}/fuzz_targets.cpp)
  file(CONFIGURE OUTPUT ${registry} CONTENT [[// Written by cmake/fuzz.cmake.
#include "tests/fuzz/fuzz.h"

namespace vkopple::fuzz {
@declarations@
std::vector<Target> targets() { return {@rows@}; }
}  // namespace vkopple::fuzz
]] @ONLY)
  target_sources(${target} PRIVATE ${registry})
endfunction()

# A program of libFuzzer for each, fuzz_<name>; all by the target `fuzz`. Needs clang, and libraries that were built with
# -fsanitize=fuzzer-no-link.
function(vkopple_fuzz_programs)
  add_custom_target(fuzz)
  add_library(fuzz_support STATIC EXCLUDE_FROM_ALL tests/fuzz/fuzz.cpp tests/fuzz/input_file.cpp tests/fuzz/quiet.cpp)
  target_link_libraries(fuzz_support PUBLIC vkopple_train)
  foreach(source IN LISTS fuzz_target_sources)
    get_filename_component(name ${source} NAME_WE)
    add_executable(fuzz_${name} EXCLUDE_FROM_ALL ${source} tests/fuzz/libfuzzer.cpp)
    target_compile_definitions(fuzz_${name} PRIVATE VKOPPLE_FUZZ_TARGET=${name})
    target_link_libraries(fuzz_${name} PRIVATE fuzz_support)
    target_link_options(fuzz_${name} PRIVATE -fsanitize=fuzzer)
    add_dependencies(fuzz fuzz_${name})
  endforeach()
endfunction()
