# Installs the library, its headers and a package that find_package(soapfilm) and pkg-config find; tests/consumer uses
# it. The program comes with its manual pages and the completion of shells. Components are packages: library,
# development, program (cmake/debian.cmake).
include(CMakePackageConfigHelpers)

set(SOAPFILM_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/soapfilm)
install(TARGETS soapfilm EXPORT soapfilm-targets
  RUNTIME COMPONENT library
  LIBRARY COMPONENT library NAMELINK_COMPONENT development
  ARCHIVE COMPONENT development)
install(EXPORT soapfilm-targets NAMESPACE soapfilm:: DESTINATION ${SOAPFILM_PACKAGE_DIR} COMPONENT development)
install(DIRECTORY include/soapfilm ${PROJECT_BINARY_DIR}/generated/soapfilm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  COMPONENT development FILES_MATCHING PATTERN "*.h")

get_target_property(SOAPFILM_LIBRARY_TYPE soapfilm TYPE)
configure_package_config_file(cmake/soapfilm-config.cmake.in ${PROJECT_BINARY_DIR}/soapfilm-config.cmake
  INSTALL_DESTINATION ${SOAPFILM_PACKAGE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/soapfilm-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/soapfilm-config.cmake ${PROJECT_BINARY_DIR}/soapfilm-config-version.cmake
  DESTINATION ${SOAPFILM_PACKAGE_DIR} COMPONENT development)

# pkg-config, for programs in C and builds without CMake. A static library names what it needs itself.
set(SOAPFILM_PC_REQUIRES "")
set(SOAPFILM_PC_LIBS "")
if(SOAPFILM_LIBRARY_TYPE STREQUAL "STATIC_LIBRARY")
  set(SOAPFILM_PC_REQUIRES "fmt libhwy pugixml")
  if(TinyGLTF_FOUND)
    string(APPEND SOAPFILM_PC_REQUIRES " tinygltf")
  endif()
  if(NOT SOAPFILM_STD_THREADS)
    string(APPEND SOAPFILM_PC_REQUIRES " tbb")
  endif()
  set(SOAPFILM_PC_LIBS "-lstdc++ -lm -pthread")
endif()
file(RELATIVE_PATH SOAPFILM_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" SOAPFILM_PC_PREFIX ${SOAPFILM_PC_PREFIX})
configure_file(cmake/soapfilm.pc.in ${PROJECT_BINARY_DIR}/soapfilm.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/soapfilm.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT development)

if(SOAPFILM_BUILD_CLI)
  install(TARGETS soapfilm_cli COMPONENT program)
  # Made by the program from its options; a program for another machine cannot run here.
  if(NOT CMAKE_CROSSCOMPILING OR CMAKE_CROSSCOMPILING_EMULATOR)
    set(SOAPFILM_ZSH_DIR ${CMAKE_INSTALL_DATADIR}/zsh/site-functions CACHE STRING "Where zsh looks for completion")
    set(pages ${PROJECT_BINARY_DIR}/pages)
    add_custom_command(OUTPUT ${pages}/made
      COMMAND ${CMAKE_COMMAND} -D "PROGRAM=${CMAKE_CROSSCOMPILING_EMULATOR};$<TARGET_FILE:soapfilm_cli>"
      -D OUT=${pages} -P ${PROJECT_SOURCE_DIR}/cmake/pages.cmake
      DEPENDS soapfilm_cli ${PROJECT_SOURCE_DIR}/cmake/pages.cmake
      COMMENT "Manual pages and completion" VERBATIM)
    add_custom_target(soapfilm_pages ALL DEPENDS ${pages}/made)
    install(DIRECTORY ${pages}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
    install(FILES ${pages}/completion.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
      RENAME soapfilm COMPONENT program)
    install(FILES ${pages}/completion.zsh DESTINATION ${SOAPFILM_ZSH_DIR} RENAME _soapfilm COMPONENT program)
    install(FILES ${pages}/completion.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
      RENAME soapfilm.fish COMPONENT program)
  endif()
endif()
