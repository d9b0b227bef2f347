# Finds the formats of data sets: every train/formats/readers/<name>_format.cpp defines `SceneFormat <name>_format()`.
# Adding one edits no list.
function(vkopple_register_formats target)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/train/formats/readers/*_format.cpp)
  set(declarations "")
  set(calls "")
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME_WE)
    string(APPEND declarations "SceneFormat ${name}();\n")
    string(APPEND calls "${name}(), ")
  endforeach()
  set(registry ${CMAKE_BINARY_DIR}/format_registry.cpp)
  file(CONFIGURE OUTPUT ${registry} CONTENT [[// Written by cmake/formats.cmake.
#include "train/formats/scene_reader.h"

namespace vkopple {
@declarations@
std::vector<SceneFormat> scene_formats() { return {@calls@}; }
}  // namespace vkopple
]] @ONLY)
  target_sources(${target} PRIVATE ${registry})
endfunction()
