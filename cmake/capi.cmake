# libvkopple: the C interface of capi/vkopple.h as a shared library, with what other projects find it by.
include(CMakePackageConfigHelpers)

file(GLOB capi_sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/capi/*.cpp)
add_library(vkopple_c SHARED ${capi_sources})
target_link_libraries(vkopple_c PRIVATE vkopple_train)
target_compile_definitions(vkopple_c PRIVATE VKOPPLE_VERSION="${PROJECT_VERSION}")
target_include_directories(vkopple_c INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
# The map hides all but the interface, what comes from static libraries as well.
target_link_options(vkopple_c PRIVATE -Wl,--version-script=${CMAKE_SOURCE_DIR}/capi/vkopple.map
  -Wl,--as-needed)  # MPI is nothing to the library
if(NOT VKOPPLE_SANITIZE)  # whose functions the program brings
  target_link_options(vkopple_c PRIVATE -Wl,--no-undefined)
endif()
set_target_properties(vkopple_c PROPERTIES
  OUTPUT_NAME vkopple EXPORT_NAME vkopple VERSION ${PROJECT_VERSION} SOVERSION 0 PUBLIC_HEADER capi/vkopple.h
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON LINK_DEPENDS ${CMAKE_SOURCE_DIR}/capi/vkopple.map)

install(TARGETS vkopple_c EXPORT vkoppleTargets
  LIBRARY COMPONENT library NAMELINK_COMPONENT development
  PUBLIC_HEADER COMPONENT development)
set(vkopple_package ${CMAKE_INSTALL_LIBDIR}/cmake/vkopple)
install(EXPORT vkoppleTargets NAMESPACE vkopple:: DESTINATION ${vkopple_package} COMPONENT development)
configure_package_config_file(capi/vkoppleConfig.cmake.in ${CMAKE_BINARY_DIR}/vkoppleConfig.cmake
  INSTALL_DESTINATION ${vkopple_package})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/vkoppleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/vkoppleConfig.cmake ${CMAKE_BINARY_DIR}/vkoppleConfigVersion.cmake
  DESTINATION ${vkopple_package} COMPONENT development)

file(RELATIVE_PATH VKOPPLE_PC_TO_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(capi/vkopple.pc.in ${CMAKE_BINARY_DIR}/vkopple.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/vkopple.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)
