# What cmake/shaders.cmake and cmake/shipped_shaders.cmake both know of shaders.
#
#   vkopple_shader_builds(<file> <out>)          the builds of a shader, "name access flags" each: variants × access paths
#   vkopple_shader_arguments(<out> <flags>)      arguments of the compiler but for the file and the output
#   vkopple_needs_cooperative(<file> <out>)      whether a shader needs a compiler that knows GL_KHR_cooperative_matrix
#   vkopple_knows_cooperative(<folder> <glslang> <spirv_val>)
#                                                whether they do, the compiler and the validator; written into these variables

set(VKOPPLE_SHADERS ${CMAKE_CURRENT_LIST_DIR}/../shaders)
cmake_path(NORMAL_PATH VKOPPLE_SHADERS)

function(vkopple_shader_builds file out)
  get_filename_component(stem ${file} NAME_WE)
  file(STRINGS ${file} first LIMIT_COUNT 1)
  set(variants "none")
  if(first MATCHES "^// variants: (.*)$")
    string(REPLACE " " ";" variants "${CMAKE_MATCH_1}")
  endif()
  set(builds "")
  foreach(variant IN LISTS variants)
    set(name ${stem})
    set(flags "")
    if(NOT variant STREQUAL "none")
      set(name ${stem}.${variant})
      string(TOUPPER ${variant} upper)
      set(flags " -D${upper}")
    endif()
    list(APPEND builds "${name} texel${flags} -DTEXEL" "${name} storage${flags}")
  endforeach()
  set(${out} "${builds}" PARENT_SCOPE)
endfunction()

function(vkopple_shader_arguments out flags)
  set(${out} -V --quiet --target-env vulkan1.1 -I${VKOPPLE_SHADERS}/include ${flags} -S comp PARENT_SCOPE)
endfunction()

function(vkopple_needs_cooperative file out)
  file(STRINGS ${file} lines REGEX "^#extension GL_KHR_cooperative_matrix")
  list(LENGTH lines count)
  set(${out} ${count} PARENT_SCOPE)
endfunction()

function(vkopple_knows_cooperative folder glslang spirv_val)
  file(WRITE ${folder}/probe.comp [[
#version 450
#extension GL_EXT_shader_explicit_arithmetic_types_float16 : require
#extension GL_KHR_cooperative_matrix : require
#extension GL_KHR_memory_scope_semantics : require
layout(local_size_x = 32) in;
shared uvec4 tile[32];
void main() {
  coopmat<float16_t, gl_ScopeSubgroup, 16, 16, gl_MatrixUseA> m;
  coopMatLoad(m, tile, 0, 2, gl_CooperativeMatrixLayoutRowMajor);
  coopMatStore(m, tile, 0, 2, gl_CooperativeMatrixLayoutRowMajor);
}
]])
  vkopple_shader_arguments(arguments "")
  execute_process(COMMAND ${GLSLANG} ${arguments} ${folder}/probe.comp -o ${folder}/probe.spv
                  RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
  set(compiles OFF)
  set(validates OFF)
  if(failed EQUAL 0)
    set(compiles ON)
    execute_process(COMMAND ${SPIRV_VAL} --target-env vulkan1.1 ${folder}/probe.spv
                    RESULT_VARIABLE failed OUTPUT_QUIET ERROR_QUIET)
    if(failed EQUAL 0)
      set(validates ON)
    endif()
  endif()
  set(${glslang} ${compiles} PARENT_SCOPE)
  set(${spirv_val} ${validates} PARENT_SCOPE)
endfunction()
