# Debian packages, by `cpack -G DEB`: pcavr (the command), libpcavr-dev (headers, static libraries, CMake
# package) and, with PCAVR_BUILD_PYTHON, python3-pcavr. scripts/build-packages makes them.
include_guard(GLOBAL)

# pcavr_package(COMPONENT NAME SECTION SUMMARY)
# One package from the files of an install component, with its copyright and changelogs.
function(pcavr_package component name section summary)
  string(TOUPPER ${component} key)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${summary}\n${PCAVR_PACKAGE_DESCRIPTION}" PARENT_SCOPE)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
  # In packages only: a plain `cmake --install` has LICENSE and CHANGELOG.md of the sources beside it.
  install(FILES ${PROJECT_SOURCE_DIR}/packaging/copyright
                ${PROJECT_BINARY_DIR}/packaging/changelog.gz
                ${PROJECT_BINARY_DIR}/packaging/changelog.Debian.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

# pcavr_compress(FILE NAME): without name and time of the file, so that the same file gives the same bytes.
function(pcavr_compress file name)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/packaging)
  execute_process(COMMAND gzip -9nc ${file} OUTPUT_FILE ${PROJECT_BINARY_DIR}/packaging/${name}
                  COMMAND_ERROR_IS_FATAL ANY)
endfunction()

pcavr_compress(${PROJECT_SOURCE_DIR}/CHANGELOG.md changelog.gz)
pcavr_compress(${PROJECT_SOURCE_DIR}/packaging/changelog changelog.Debian.gz)

set(PCAVR_PACKAGE_DESCRIPTION
    "pcavr builds a scene in a robot's base frame from recorded depth frames,
identifies contact and friction of the movable objects, predicts their motion
without the delay of the link to the robot, and corrects it by tracking.")
pcavr_package(runtime pcavr science "point-cloud augmented VR scenes from depth recordings")
pcavr_package(development libpcavr-dev libdevel "libraries of pcavr: headers, static libraries")
if(PCAVR_BUILD_PYTHON)
  pcavr_package(python python3-pcavr python "scenes, friction and predicted pushes from Python")
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VENDOR "The pcavr authors")
set(PCAVR_MAINTAINER "The pcavr authors <maintainers@users.noreply.github.com>"
    CACHE STRING "Who passes the Debian packages on: NAME <ADDRESS>; nobody reads mail to the default")
set(CPACK_PACKAGE_CONTACT ${PCAVR_MAINTAINER})
# Each package has its own; the project's would be put above it.
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS gltfpack) # serve compresses large meshes with it
# The static libraries need at link time what the build needs.
get_property(development_packages GLOBAL PROPERTY PCAVR_DEVELOPMENT_PACKAGES)
list(REMOVE_DUPLICATES development_packages)
list(JOIN development_packages ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
# The extension is for one version of Python.
if(PCAVR_BUILD_PYTHON)
  math(EXPR next_minor "${Python3_VERSION_MINOR} + 1")
  set(python3 "python3 (>= 3.${Python3_VERSION_MINOR}~), python3 (<< 3.${next_minor})")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "${python3}, python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
      ${PROJECT_SOURCE_DIR}/packaging/postinst ${PROJECT_SOURCE_DIR}/packaging/prerm)
endif()
include(CPack)
