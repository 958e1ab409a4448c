# cmake -D BUILD= -D WORK= -D GENERATOR= -D C_COMPILER= -D CXX_COMPILER= -D VERSION= -P run.cmake
# Installs BUILD into an empty prefix under WORK, then configures, builds and runs the outside projects beside this
# file.
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    string(REPLACE ";" " " command "${ARGV}")
    message(FATAL_ERROR "failed (${result}): ${command}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
# The program, where it is built, comes with its pages.
if(EXISTS ${WORK}/prefix/bin/soapfilm)
  run(${WORK}/prefix/bin/soapfilm --version)
  foreach(page man/man1/soapfilm.1 man/man1/soapfilm-reconstruct.1 bash-completion/completions/soapfilm
      fish/vendor_completions.d/soapfilm.fish)
    if(NOT EXISTS ${WORK}/prefix/share/${page})
      message(FATAL_ERROR "share/${page} is not installed")
    endif()
  endforeach()
endif()
foreach(project cpp c)
  run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/${project} -B ${WORK}/${project} -G ${GENERATOR}
    -D CMAKE_C_COMPILER=${C_COMPILER} -D CMAKE_CXX_COMPILER=${CXX_COMPILER} -D CMAKE_BUILD_TYPE=Release
    -D CMAKE_PREFIX_PATH=${WORK}/prefix -D EXPECTED_VERSION=${VERSION})
  run(${CMAKE_COMMAND} --build ${WORK}/${project})
  run(${CMAKE_COMMAND} -E chdir ${WORK}/${project} ./consumer)
  if(NOT output MATCHES "soapfilm ${VERSION}")
    message(FATAL_ERROR "the ${project} consumer printed '${output}', expected soapfilm ${VERSION}")
  endif()
endforeach()

# Our warnings, sanitizers and private libraries must not reach the consumer.
file(GLOB_RECURSE export ${WORK}/prefix/soapfilm-targets.cmake)
file(READ ${export} targets)
if(targets MATCHES "soapfilm_options|-Wall|-ffp-contract|Eigen|nanoflann|nlohmann")
  message(FATAL_ERROR "the exported package leaks '${CMAKE_MATCH_0}'")
endif()
