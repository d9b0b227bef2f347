# Finds the subcommands: every tools/commands/<name>.cpp defines `void add_<name>(CLI::App&)`. Adding one edits no list.
function(vkopple_register_commands target)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tools/commands/*.cpp)
  set(declarations "")
  set(names "")
  foreach(source IN LISTS sources)
    get_filename_component(name ${source} NAME_WE)
    string(APPEND declarations "void add_${name}(CLI::App&);\n")
    string(APPEND names "add_${name}, ")
  endforeach()
  set(registry ${CMAKE_BINARY_DIR}/command_registry.cpp)
  file(CONFIGURE OUTPUT ${registry} CONTENT [[// Written by cmake/commands.cmake.
#include "tools/commands.h"

namespace vkopple {
@declarations@
std::vector<AddCommand> all_commands() { return {@names@}; }
}  // namespace vkopple
]] @ONLY)
  target_sources(${target} PRIVATE ${registry})
endfunction()
