# Run by cpack on what was installed for the packages, before they are made: Debian's policy asks for compressed manual
# pages and changelogs. (gzip -n: without a time stamp.)
file(GLOB_RECURSE files LIST_DIRECTORIES false ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*)
foreach(file IN LISTS files)
  if(file MATCHES "/man1/[^/]+\\.1$|/doc/[^/]+/(changelog|CHANGELOG\\.md)$")
    execute_process(COMMAND gzip -9n ${file} COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
