# Finds the ops and their checks: every graph/ops/<op>.h is an op, every graph/checks/<op>.cpp but check*.cpp its check,
# which defines `void check_<op>(CheckList&)`. Adding an op edits no list.
function(vkopple_register_ops target)
  file(GLOB op_headers CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/graph/ops/*.h)
  file(GLOB check_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/graph/checks/*.cpp)
  set(names "")
  foreach(header IN LISTS op_headers)
    get_filename_component(op ${header} NAME_WE)
    string(APPEND names "\"${op}\", ")
  endforeach()
  set(declarations "")
  set(calls "")
  foreach(source IN LISTS check_sources)
    get_filename_component(op ${source} NAME_WE)
    if(NOT op MATCHES "^check")
      string(APPEND declarations "void check_${op}(CheckList&);\n")
      string(APPEND calls "  {\n    OpChecks checks{\"${op}\", {}};\n    check_${op}(checks.cases);\n"
                          "    all.push_back(std::move(checks));\n  }\n")
    endif()
  endforeach()
  set(registry ${CMAKE_BINARY_DIR}/check_registry.cpp)
  file(CONFIGURE OUTPUT ${registry} CONTENT [[// Written by cmake/ops.cmake.
#include "graph/checks/check.h"

namespace vkopple {
@declarations@
std::vector<OpChecks> all_checks() {
  std::vector<OpChecks> all;
@calls@  return all;
}
std::vector<std::string_view> all_ops() { return {@names@}; }
}  // namespace vkopple
]] @ONLY)
  target_sources(${target} PRIVATE ${registry})
endfunction()
