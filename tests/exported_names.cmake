# cmake -D LIBRARY=libsoapfilm.so -D NM=nm -D INCLUDE=include/soapfilm -P exported_names.cmake
# A shared library exports what the public headers declare, and nothing else of ours: every exported function belongs to
# a name of namespace soapfilm that a public header has, or is one of the C interface.
execute_process(COMMAND ${NM} --dynamic --defined-only --demangle ${LIBRARY} OUTPUT_VARIABLE symbols
  COMMAND_ERROR_IS_FATAL ANY)
file(GLOB headers ${INCLUDE}/*.h)
set(public "")
foreach(header ${headers})
  file(READ ${header} text)
  string(APPEND public "${text}")
endforeach()

string(REGEX MATCHALL "[0-9a-f]+ T [^\n]+" functions "${symbols}")
list(LENGTH functions count)
if(count LESS 40)
  message(FATAL_ERROR "${LIBRARY} exports ${count} functions: the public ones are not among them")
endif()
foreach(function ${functions})
  string(REGEX REPLACE "^[0-9a-f]+ T (soapfilm::)?([A-Za-z0-9_]+).*" "\\2" name "${function}")
  if(NOT public MATCHES "[^A-Za-z0-9_]${name}[^A-Za-z0-9_]")
    message(SEND_ERROR "exported, but in no public header: ${function}")
  endif()
endforeach()
