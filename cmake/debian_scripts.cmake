# Run by cpack on the finished packages: takes out the postinst and postrm that cpack adds to each package with a shared
# library. They call ldconfig, which the package's trigger does (Debian's policy, 8.1.1), and cpack 3.25 has no option
# against them.
foreach(package IN LISTS CPACK_PACKAGE_FILES)
  set(unpacked ${CPACK_TOPLEVEL_DIRECTORY}/without-scripts)
  file(REMOVE_RECURSE ${unpacked})
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${unpacked} COMMAND_ERROR_IS_FATAL ANY)
  if(NOT EXISTS ${unpacked}/DEBIAN/triggers)
    continue()
  endif()
  foreach(script postinst postrm)
    file(READ ${unpacked}/DEBIAN/${script} text)
    if(NOT text MATCHES "ldconfig")
      message(FATAL_ERROR "${package}: ${script} is not the one that cpack adds:\n${text}")
    endif()
    file(REMOVE ${unpacked}/DEBIAN/${script})
  endforeach()
  execute_process(COMMAND dpkg-deb --root-owner-group -Zxz --build ${unpacked} ${package} OUTPUT_QUIET
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
