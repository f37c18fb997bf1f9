# Functions that define pcavr targets: warnings, include folders and install rules.
include_guard(GLOBAL)
include(GNUInstallDirs)

# Strict warnings for our own code; the headers of other libraries are included as system headers.
function(pcavr_compile_options target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wshadow -Wconversion
                         $<$<BOOL:${PCAVR_WARNINGS_AS_ERRORS}>:-Werror>
                         # GCC 12 reports false overlaps in std::string's operator+ (GCC bug 105651).
                         $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>
                         # In a unity build GCC warns about types of an unnamed namespace.
                         $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-subobject-linkage>
                         # Clang's -Wconversion includes signedness, GCC's does not.
                         $<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion>
                         # The same floating-point results at every optimisation level and instruction set.
                         -ffp-contract=off)
endfunction()

# pcavr_add_room(ROOM module...)
# A folder of modules; or, without modules, a room that is one module itself.
function(pcavr_add_room room)
  if(NOT ARGN)
    add_subdirectory(${room})
    set_property(GLOBAL APPEND PROPERTY PCAVR_MODULES ${room})
  endif()
  foreach(module IN LISTS ARGN)
    add_subdirectory(${room}/${module})
    set_property(GLOBAL APPEND PROPERTY PCAVR_MODULES ${module})
  endforeach()
endfunction()

# pcavr_add_module(NAME SOURCES file... [DEPENDS module...] [PRIVATE library...])
# DEPENDS are pcavr modules (public); PRIVATE are libraries that stay out of public headers.
function(pcavr_add_module name)
  cmake_parse_arguments(arg "" "" "SOURCES;DEPENDS;PRIVATE" ${ARGN})
  add_library(pcavr_${name} STATIC ${arg_SOURCES})
  add_library(pcavr::${name} ALIAS pcavr_${name})
  set_target_properties(pcavr_${name} PROPERTIES EXPORT_NAME ${name}
                        POSITION_INDEPENDENT_CODE ON)
  pcavr_compile_options(pcavr_${name})
  target_include_directories(pcavr_${name}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
           $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  foreach(dependency IN LISTS arg_DEPENDS)
    target_link_libraries(pcavr_${name} PUBLIC pcavr::${dependency})
  endforeach()
  target_link_libraries(pcavr_${name} PRIVATE ${arg_PRIVATE})
  if(PCAVR_BUILD_FUZZERS) # fuzzers are guided by the coverage of the modules, not of the tests
    target_compile_options(pcavr_${name} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
  install(TARGETS pcavr_${name} EXPORT pcavrTargets ARCHIVE COMPONENT development)
endfunction()

# pcavr_add_tests(NAME SOURCES file... [NO_UNITY file...] LINK library... [LABELS label...])
# Tests with the label memory are of modules that read files, messages and shared memory:
# built by the target pcavr_memory_tests too, for the address sanitizer; so are those with the label fast,
# by pcavr_fast_tests, and with the label threaded, for the thread sanitizer. Those with the label nightly
# are built by pcavr_nightly_tests alone.
# NO_UNITY lists sources that are excluded from unity builds, because their helpers have the same
# names as another source's. One executable; each TEST becomes a CTest case with these labels, or
# with AS_ONE all of them together, for tests that share an expensive setup. PCAVR_TESTS_AS_ONE does
# so for every executable (ON), or for those with the label fast (FAST): a start takes longer than most
# of these tests, and half a second under a sanitizer.
function(pcavr_add_tests name)
  cmake_parse_arguments(arg "AS_ONE" "TIMEOUT" "SOURCES;NO_UNITY;LINK;LABELS" ${ARGN})
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  add_executable(pcavr_${name}_tests ${arg_SOURCES} ${arg_NO_UNITY})
  if(nightly IN_LIST arg_LABELS OR (memory IN_LIST arg_LABELS AND NOT PCAVR_BUILD_MEMORY_TESTS))
    set_target_properties(pcavr_${name}_tests PROPERTIES EXCLUDE_FROM_ALL TRUE)
  endif()
  if(arg_NO_UNITY)
    set_source_files_properties(${arg_NO_UNITY} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  endif()
  pcavr_compile_options(pcavr_${name}_tests)
  # Tests call optimised libraries; their own code takes a quarter less time to compile so, and two
  # fifths less under sanitizers.
  target_compile_options(pcavr_${name}_tests PRIVATE $<$<CONFIG:RelWithDebInfo>:-O1> $<$<CONFIG:Debug>:-O0>)
  target_include_directories(pcavr_${name}_tests PRIVATE ${PROJECT_SOURCE_DIR}/src
                             ${PROJECT_SOURCE_DIR}/tests)
  target_link_libraries(pcavr_${name}_tests PRIVATE ${arg_LINK} pcavr_test_support
                        GTest::gtest_main)
  foreach(label fast memory nightly threaded)
    if(label IN_LIST arg_LABELS)
      add_dependencies(pcavr_${label}_tests pcavr_${name}_tests)
    endif()
  endforeach()
  string(TOUPPER "${PCAVR_TESTS_AS_ONE}" as_one)
  if(arg_AS_ONE OR as_one STREQUAL "ON" OR nightly IN_LIST arg_LABELS OR (as_one STREQUAL "FAST" AND fast IN_LIST arg_LABELS))
    if(NOT arg_AS_ONE)
      set(arg_TIMEOUT 1200) # of all tests together
    endif()
    add_test(NAME ${name} COMMAND pcavr_${name}_tests)
    set_tests_properties(${name} PROPERTIES LABELS "${arg_LABELS}" TIMEOUT ${arg_TIMEOUT})
    return()
  endif()
  gtest_discover_tests(pcavr_${name}_tests TEST_PREFIX "${name}." DISCOVERY_TIMEOUT 60
                       TEST_LIST pcavr_${name}_cases PROPERTIES TIMEOUT ${arg_TIMEOUT})
  # Labels are set by a separate file: gtest_discover_tests splits a list of labels.
  set(labels_file ${CMAKE_CURRENT_BINARY_DIR}/pcavr_${name}_labels.cmake)
  file(WRITE ${labels_file}
       "set_tests_properties(\${pcavr_${name}_cases} PROPERTIES LABELS \"${arg_LABELS}\")\n")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${labels_file})
endfunction()
