# Makes find_package(pcavr) work after cmake --install.
include_guard(GLOBAL)
include(CMakePackageConfigHelpers)

set(pcavr_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcavr)
# The public headers alone: what others include may change without notice.
execute_process(COMMAND ${CMAKE_CURRENT_SOURCE_DIR}/scripts/public-headers OUTPUT_VARIABLE public_headers
                OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" public_headers "${public_headers}")
# The list is made anew where what it follows from has changed.
file(GLOB_RECURSE public_header_users CONFIGURE_DEPENDS samples/*.cpp python/bindings/*.[ch]pp tests/package/*.cpp)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS scripts/public-headers ${public_header_users})
foreach(header IN LISTS public_headers)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS include/${header})
  cmake_path(GET header PARENT_PATH folder)
  install(FILES include/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder} COMPONENT development)
endforeach()
install(DIRECTORY samples/ DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libpcavr-dev/examples
        COMPONENT development PATTERN CMakeLists.txt EXCLUDE)
install(DIRECTORY calib/ DESTINATION ${CMAKE_INSTALL_DATADIR}/pcavr/calib COMPONENT runtime)
install(EXPORT pcavrTargets NAMESPACE pcavr:: DESTINATION ${pcavr_package_dir} COMPONENT development)
configure_package_config_file(cmake/pcavrConfig.cmake.in pcavrConfig.cmake
                              INSTALL_DESTINATION ${pcavr_package_dir})
write_basic_package_version_file(pcavrConfigVersion.cmake COMPATIBILITY SameMinorVersion)
# The static modules need their libraries at link time, found by the same rules as here.
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/pcavrConfig.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/pcavrConfigVersion.cmake
              cmake/PcavrDependencies.cmake
        DESTINATION ${pcavr_package_dir} COMPONENT development)
