# vkopple_messages(<target> <file.proto>...)
#
# A static library of protobuf messages. Sources that link it include them as "<file>.pb.h". What the compiler of protobuf writes
# is not held to this project's warnings.
function(vkopple_messages target)
  set(folder ${CMAKE_BINARY_DIR}/generated/${target})
  file(MAKE_DIRECTORY ${folder})
  set(sources "")
  foreach(file IN LISTS ARGN)
    get_filename_component(file ${file} ABSOLUTE)
    get_filename_component(name ${file} NAME_WE)
    get_filename_component(from ${file} DIRECTORY)
    add_custom_command(
      OUTPUT ${folder}/${name}.pb.cc ${folder}/${name}.pb.h
      COMMAND protobuf::protoc --proto_path=${from} --cpp_out=${folder} ${file}
      DEPENDS ${file}
      COMMENT "Messages ${name}" VERBATIM)
    list(APPEND sources ${folder}/${name}.pb.cc)
  endforeach()
  set_source_files_properties(${sources} PROPERTIES COMPILE_OPTIONS -w)
  add_library(${target} STATIC ${sources})
  target_include_directories(${target} SYSTEM PUBLIC ${folder})
  target_link_libraries(${target} PUBLIC protobuf::libprotobuf-lite)
endfunction()
