# Installs the library, its headers and a package that find_package(soapfilm) finds; tests/consumer uses it.
include(CMakePackageConfigHelpers)

set(SOAPFILM_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/soapfilm)
install(TARGETS soapfilm EXPORT soapfilm-targets)
install(EXPORT soapfilm-targets NAMESPACE soapfilm:: DESTINATION ${SOAPFILM_PACKAGE_DIR})
install(DIRECTORY include/soapfilm ${PROJECT_BINARY_DIR}/generated/soapfilm DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}
  FILES_MATCHING PATTERN "*.h")
if(SOAPFILM_BUILD_CLI)
  install(TARGETS soapfilm_cli)
endif()

get_target_property(SOAPFILM_LIBRARY_TYPE soapfilm TYPE)
configure_package_config_file(cmake/soapfilm-config.cmake.in ${PROJECT_BINARY_DIR}/soapfilm-config.cmake
  INSTALL_DESTINATION ${SOAPFILM_PACKAGE_DIR} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/soapfilm-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/soapfilm-config.cmake ${PROJECT_BINARY_DIR}/soapfilm-config-version.cmake
  DESTINATION ${SOAPFILM_PACKAGE_DIR})
