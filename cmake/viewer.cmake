# Bundles viewer/ into one page and compiles it into the tools. Packages come from the npm registry by the lock file,
# into the build folder: nothing is written to the sources.
if(NOT SOAPFILM_NODE OR NOT SOAPFILM_NPM)
  message(FATAL_ERROR "SOAPFILM_VIEWER needs node and npm (on Debian: apt-get install nodejs npm)")
endif()
set(viewer ${PROJECT_BINARY_DIR}/viewer)
file(GLOB viewer_sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/viewer/src/*)
set(viewer_lock ${PROJECT_SOURCE_DIR}/viewer/package.json ${PROJECT_SOURCE_DIR}/viewer/package-lock.json
  ${PROJECT_SOURCE_DIR}/viewer/.npmrc)

add_custom_command(OUTPUT ${viewer}/installed
  COMMAND ${CMAKE_COMMAND} -E make_directory ${viewer}
  COMMAND ${CMAKE_COMMAND} -E copy ${viewer_lock} ${viewer}
  COMMAND ${SOAPFILM_NPM} ci --omit=dev --loglevel=error --prefix ${viewer}
    || ${CMAKE_COMMAND} -E cmake_echo_color --red
    "npm found no packages: without network configure with -DSOAPFILM_VIEWER=OFF"
  COMMAND ${CMAKE_COMMAND} -E copy ${viewer}/node_modules/esbuild/package.json ${viewer}/installed
  DEPENDS ${viewer_lock} COMMENT "Installing the viewer's npm packages" VERBATIM)
add_custom_command(OUTPUT ${viewer}/page.cpp BYPRODUCTS ${viewer}/page.html
  COMMAND ${SOAPFILM_NODE} ${PROJECT_SOURCE_DIR}/viewer/build.mjs ${viewer}/node_modules ${viewer}
  DEPENDS ${viewer}/installed ${viewer_sources} ${PROJECT_SOURCE_DIR}/viewer/build.mjs
  COMMENT "Bundling the viewer" VERBATIM)

target_sources(soapfilm_tools PRIVATE ${viewer}/page.cpp)
target_compile_definitions(soapfilm_tools PRIVATE SOAPFILM_VIEWER)
# A text of half a megabyte is what it is to be.
set_source_files_properties(${viewer}/page.cpp PROPERTIES COMPILE_OPTIONS
  "$<$<CXX_COMPILER_ID:Clang,AppleClang>:-Wno-overlength-strings>")
