# Finds every shaders/**/*.comp, compiles each of its variants for both access paths to SPIR-V, validates them and embeds them.
#
#   vkopple_embed_shaders(<target>)    adds the generated shader library to <target>
#
# A shader whose first line is "// variants: forward backward" is compiled once with -DFORWARD and once with -DBACKWARD, and
# named file.forward and file.backward. One that needs GL_KHR_cooperative_matrix is compiled where the compiler knows that; elsewhere
# (glslang 12 of Debian 12) its SPIR-V comes from the folder spirv beside it, which the target ship_shaders writes.
find_program(GLSLANG NAMES glslangValidator glslang REQUIRED)
find_program(SPIRV_VAL spirv-val REQUIRED)
include(${CMAKE_CURRENT_LIST_DIR}/shader_builds.cmake)

# One build of a shader: <spv> is the file to embed, made by the build where it is compiled.
function(vkopple_shader_spirv file name access flags spv)
  vkopple_needs_cooperative(${file} cooperative)
  get_filename_component(folder ${file} DIRECTORY)
  if(cooperative AND NOT GLSLANG_COOPERATIVE)
    set(${spv} ${folder}/spirv/${name}.${access}.spv PARENT_SCOPE)
    return()
  endif()
  set(output ${CMAKE_BINARY_DIR}/shaders/${name}.${access}.spv)
  set(validate COMMAND ${SPIRV_VAL} --target-env vulkan1.1 ${output})
  if(cooperative AND NOT SPIRV_VAL_COOPERATIVE)
    set(validate "")
  endif()
  vkopple_shader_arguments(arguments "${flags}")
  file(GLOB_RECURSE includes CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.glsl)
  add_custom_command(
    OUTPUT ${output}
    COMMAND ${GLSLANG} ${arguments} ${file} -o ${output}
    ${validate}
    DEPENDS ${file} ${includes}
    COMMENT "Shader ${name} (${access})" VERBATIM)
  set(${spv} ${output} PARENT_SCOPE)
endfunction()

function(vkopple_embed_shaders target)
  file(GLOB_RECURSE files CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/shaders/*.comp)
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/shaders)
  vkopple_knows_cooperative(${CMAKE_BINARY_DIR}/shaders GLSLANG_COOPERATIVE SPIRV_VAL_COOPERATIVE)
  set(blobs "")
  set(symbols "")
  set(table "")
  set(outputs "")
  set(index 0)
  foreach(file IN LISTS files)
    # A changed variant line changes the table, which configuring writes.
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    vkopple_shader_builds(${file} builds)
    foreach(build IN LISTS builds)
      string(REPLACE " " ";" flags "${build}")
      list(POP_FRONT flags name access)
      set(access_value "AccessPath::kStorage")
      if(access STREQUAL "texel")
        set(access_value "AccessPath::kTexel")
      endif()
      vkopple_shader_spirv(${file} ${name} ${access} "${flags}" spv)
      list(APPEND outputs ${spv})
      string(APPEND blobs ".balign 4\\n.global vkopple_spv_${index}\\nvkopple_spv_${index}:\\n.incbin \\\"${spv}\\\"\\n"
                          ".global vkopple_spv_${index}_end\\nvkopple_spv_${index}_end:\\n")
      string(APPEND symbols "extern \"C\" const uint32_t vkopple_spv_${index}[], vkopple_spv_${index}_end[];\n")
      string(APPEND table "    {\"${name}\", ${access_value}, {vkopple_spv_${index}, vkopple_spv_${index}_end}},\n")
      math(EXPR index "${index} + 1")
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

# The target ship_shaders, and a test that the SPIR-V shipped is that of the sources.
function(vkopple_check_shipped_shaders)
  set(script ${CMAKE_COMMAND} -DGLSLANG=${GLSLANG} -DSPIRV_VAL=${SPIRV_VAL} -DFOLDER=${CMAKE_BINARY_DIR}/shipped_shaders)
  add_custom_target(ship_shaders COMMAND ${script} -DWRITE=ON -P ${CMAKE_SOURCE_DIR}/cmake/shipped_shaders.cmake VERBATIM)
  add_test(NAME shipped_shaders COMMAND ${script} -P ${CMAKE_SOURCE_DIR}/cmake/shipped_shaders.cmake)
endfunction()
