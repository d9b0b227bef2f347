# Finds every shaders/**/*.comp, compiles each of its variants for both access paths to SPIR-V, validates them and embeds them.
#
#   vkopple_embed_shaders(<target>)    adds the generated shader library to <target>
#
# A shader whose first line is "// variants: forward backward" is compiled once with -DFORWARD and once with -DBACKWARD, and
# named file.forward and file.backward.
find_program(GLSLANG NAMES glslangValidator glslang REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)

function(vkopple_embed_shaders target)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.comp)
  file(GLOB_RECURSE includes CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.glsl)
  set(folder ${CMAKE_BINARY_DIR}/shaders)
  file(MAKE_DIRECTORY ${folder})
  set(blobs "")
  set(symbols "")
  set(table "")
  set(outputs "")
  set(index 0)
  foreach(file IN LISTS files)
    # A changed variant line changes the table, which configuring writes.
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    get_filename_component(stem ${file} NAME_WE)
    file(STRINGS ${file} first LIMIT_COUNT 1)
    set(variants "none")
    if(first MATCHES "^// variants: (.*)$")
      string(REPLACE " " ";" variants "${CMAKE_MATCH_1}")
    endif()
    foreach(variant IN LISTS variants)
      set(name ${stem})
      set(defines "")
      if(NOT variant STREQUAL "none")
        set(name ${stem}.${variant})
        string(TOUPPER ${variant} upper)
        set(defines -D${upper})
      endif()
      foreach(access texel storage)
        set(spv ${folder}/${name}.${access}.spv)
        set(access_define "")
        set(access_value "AccessPath::kStorage")
        if(access STREQUAL "texel")
          set(access_define -DTEXEL)
          set(access_value "AccessPath::kTexel")
        endif()
        add_custom_command(
          OUTPUT ${spv}
          COMMAND ${GLSLANG} -V --quiet --target-env vulkan1.1 -I${CMAKE_SOURCE_DIR}/shaders/include
                  ${defines} ${access_define} -S comp ${file} -o ${spv}
          COMMAND ${SPIRV_VAL} --target-env vulkan1.1 ${spv}
          DEPENDS ${file} ${includes}
          COMMENT "Shader ${name} (${access})" VERBATIM)
        list(APPEND outputs ${spv})
        string(APPEND blobs ".balign 4\\n.global vkopple_spv_${index}\\nvkopple_spv_${index}:\\n.incbin \\\"${spv}\\\"\\n"
                            ".global vkopple_spv_${index}_end\\nvkopple_spv_${index}_end:\\n")
        string(APPEND symbols "extern \"C\" const uint32_t vkopple_spv_${index}[], vkopple_spv_${index}_end[];\n")
        string(APPEND table "    {\"${name}\", ${access_value}, {vkopple_spv_${index}, vkopple_spv_${index}_end}},\n")
        math(EXPR index "${index} + 1")
      endforeach()
    endforeach()
  endforeach()
  set(source ${CMAKE_BINARY_DIR}/shader_library_data.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT [[// Written by cmake/shaders.cmake.
#include <array>

#include "runtime/shader_library.h"

asm(".section .rodata\n@blobs@.previous\n");
@symbols@
namespace vkopple {
std::span<const ShaderCode> shader_library() {
  static const auto table = std::to_array<ShaderCode>({
@table@  });
  return table;
}
}  // namespace vkopple
]] @ONLY)
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${outputs}" COMPILE_OPTIONS "-Wno-pedantic")
  target_sources(${target} PRIVATE ${source})
endfunction()
