# The solve on OpenCL devices: src/soapfilm/opencl, its kernels as a constant in a header.
find_package(OpenCL REQUIRED)
set(kernels ${PROJECT_SOURCE_DIR}/src/soapfilm/opencl/iteration.cl)
set(header ${PROJECT_BINARY_DIR}/generated/soapfilm/opencl/iteration_source.h)
add_custom_command(OUTPUT ${header}
  COMMAND ${CMAKE_COMMAND} -D IN=${kernels} -D OUT=${header} -D NAME=iteration_source
  -P ${PROJECT_SOURCE_DIR}/cmake/embed.cmake
  DEPENDS ${kernels} ${PROJECT_SOURCE_DIR}/cmake/embed.cmake VERBATIM)
target_sources(soapfilm_engine PRIVATE ${header})
target_include_directories(soapfilm_engine SYSTEM PUBLIC ${OpenCL_INCLUDE_DIRS})
