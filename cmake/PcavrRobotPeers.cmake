include_guard(GLOBAL)
# Orocos KDL and Bullet's btMultiBody, which compute the same: for tests and benchmarks only.
add_library(pcavr_robot_peers INTERFACE)
target_link_libraries(pcavr_robot_peers INTERFACE orocos-kdl BulletDynamics-float64
                      BulletCollision-float64 LinearMath-float64)
target_compile_definitions(pcavr_robot_peers INTERFACE BT_USE_DOUBLE_PRECISION)
target_include_directories(pcavr_robot_peers SYSTEM INTERFACE
                           ${BULLET_ROOT_DIR}/${BULLET_INCLUDE_DIR} ${orocos_kdl_INCLUDE_DIRS})
