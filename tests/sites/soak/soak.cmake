# The soak of two sites, for its test and for the benchmark of the nightly run, which is built without
# the tests.
include_guard(GLOBAL)
add_library(pcavr_soak STATIC ${CMAKE_CURRENT_LIST_DIR}/soak_checker.cpp
  ${CMAKE_CURRENT_LIST_DIR}/soak_network.cpp ${CMAKE_CURRENT_LIST_DIR}/two_sites_soak.cpp)
pcavr_compile_options(pcavr_soak)
target_include_directories(pcavr_soak PUBLIC ${PROJECT_SOURCE_DIR}/src ${PROJECT_SOURCE_DIR}/tests)
target_link_libraries(pcavr_soak PUBLIC pcavr::sites pcavr::pipeline pcavr::simulation fmt::fmt)
