# A module may include those above it in this list only (docs/architecture.md), and a public header
# no third-party library but Eigen.
cmake_minimum_required(VERSION 3.25)

set(modules core geometry contact friction identification recording model prediction haptics devices teleop marker tracking
            reconstruction scene simulation evaluation pipeline serve)
# What a heavy library's header is called when it is included.
set(heavy "opencv2/|pcl/|octomap/|ceres/|apriltag/|embree3/|assimp/|yaml-cpp/|nlohmann/|tbb/|bullet/|btBullet|png\\.h|SDL|spnav|boost/|openssl/")

set(faults 0)
foreach(module IN LISTS modules)
  list(FIND modules ${module} own_place)
  file(GLOB headers ${SOURCE_DIR}/include/pcavr/${module}/*.hpp)
  file(GLOB sources ${SOURCE_DIR}/src/${module}/*.hpp ${SOURCE_DIR}/src/${module}/*.cpp)
  foreach(file IN LISTS headers sources)
    file(STRINGS ${file} includes REGEX "^#include")
    foreach(line IN LISTS includes)
      if(line MATCHES "pcavr/([a-z]+)/")
        list(FIND modules ${CMAKE_MATCH_1} place)
        if(place LESS 0 OR place GREATER own_place)
          message(SEND_ERROR "${file}: ${module} may not use ${CMAKE_MATCH_1}")
          math(EXPR faults "${faults} + 1")
        endif()
      endif()
      if(file IN_LIST headers AND line MATCHES "${heavy}")
        message(SEND_ERROR "${file}: a public header includes a heavy library: ${line}")
        math(EXPR faults "${faults} + 1")
      endif()
    endforeach()
  endforeach()
endforeach()
if(faults GREATER 0)
  message(FATAL_ERROR "${faults} includes against the order of the modules")
endif()
