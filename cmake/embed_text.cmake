# embed_text(<out.cpp> <header> <function> <file>...)
#
# Turns text files into a C++ source with a table of name (the file's, without folder and ending) and content, sorted by name, and
# defines in namespace vkopple::embedded
#   std::span<const std::pair<std::string_view, std::string_view>> <function>();
# declared in <header>, which this writes too.
function(embed_text source header function)
  set(rows "")
  set(files ${ARGN})
  list(SORT files COMPARE FILE_BASENAME)
  foreach(file ${files})
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(name ${file} NAME_WE)
    file(READ ${file} text)
    string(APPEND rows "    {\"${name}\", R\"__embed(${text})__embed\"},\n")
  endforeach()
  get_filename_component(include ${header} NAME)
  file(CONFIGURE OUTPUT ${header} CONTENT [[
#pragma once

#include <span>
#include <string_view>
#include <utility>

namespace vkopple::embedded {
std::span<const std::pair<std::string_view, std::string_view>> @function@();
}  // namespace vkopple::embedded
]] @ONLY)
  file(CONFIGURE OUTPUT ${source} CONTENT [[
#include "@include@"

namespace vkopple::embedded {
namespace {
constexpr std::pair<std::string_view, std::string_view> kTable[] = {
@rows@};
}  // namespace

std::span<const std::pair<std::string_view, std::string_view>> @function@() { return kTable; }
}  // namespace vkopple::embedded
]] @ONLY)
endfunction()
