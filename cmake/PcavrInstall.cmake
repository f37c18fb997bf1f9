# Makes find_package(pcavr) work after cmake --install.
include_guard(GLOBAL)
include(CMakePackageConfigHelpers)

set(pcavr_package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pcavr)
install(DIRECTORY include/pcavr DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT development)
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
