# Manual pages and completion of the command for bash, zsh and fish, made from what the built command
# describes of itself. Without Python there are none.
include_guard(GLOBAL)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(NOT Python3_Interpreter_FOUND)
  message(STATUS "no manual pages and no completion: apt-get install python3")
  return()
endif()

set(manual ${PROJECT_BINARY_DIR}/manual)
set(script ${PROJECT_SOURCE_DIR}/scripts/make-command-pages)
add_custom_command(OUTPUT ${manual}/done
  COMMAND ${Python3_EXECUTABLE} ${script} $<TARGET_FILE:pcavr_app> ${manual}
  COMMAND ${CMAKE_COMMAND} -E touch ${manual}/done
  DEPENDS pcavr_app ${script} VERBATIM)
add_custom_target(pcavr_manual ALL DEPENDS ${manual}/done)

# OPTIONAL: absent where only some targets were built.
install(DIRECTORY ${manual}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT runtime OPTIONAL)
install(FILES ${manual}/completions/pcavr
        DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions COMPONENT runtime OPTIONAL)
install(FILES ${manual}/completions/_pcavr
        DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions COMPONENT runtime OPTIONAL)
install(FILES ${manual}/completions/pcavr.fish
        DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d COMPONENT runtime OPTIONAL)
