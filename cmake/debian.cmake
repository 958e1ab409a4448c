# Debian packages by cpack (make deb), one for each component of the install rules. Dependencies come from
# dpkg-shlibdeps. The version has no Debian revision: the packaging is part of these sources.
set(directory ${PROJECT_SOURCE_DIR}/packaging/debian)
file(STRINGS ${directory}/changelog heads LIMIT_COUNT 1)
if(NOT heads MATCHES "^soapfilm \\(${PROJECT_VERSION}\\)")
  message(FATAL_ERROR "packaging/debian/changelog: begins with '${heads}', must be 'soapfilm (${PROJECT_VERSION})'")
endif()
file(STRINGS ${directory}/changelog maintainers REGEX "^ -- " LIMIT_COUNT 1)
string(REGEX REPLACE "^ -- (.*>)  .*" "\\1" CPACK_PACKAGE_CONTACT "${maintainers}")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME soapfilm)
set(CPACK_PACKAGE_VENDOR "Soapfilm authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
  WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_PRE_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_files.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${PROJECT_SOURCE_DIR}/cmake/debian_scripts.cmake)

# NAME of a component, its package, section, summary and description.
set(CPACK_COMPONENTS_ALL "")
set(SOAPFILM_DEBIAN_PACKAGES "")
function(debian_package component package section summary description)
  string(TOUPPER ${component} name)
  foreach(assignment "PACKAGE_NAME=${package}" "PACKAGE_SECTION=${section}" "DESCRIPTION=${summary}\n${description}")
    string(REGEX MATCH "^([A-Z_]+)=(.*)$" matched "${assignment}")
    set(CPACK_DEBIAN_${name}_${CMAKE_MATCH_1} "${CMAKE_MATCH_2}" PARENT_SCOPE)
  endforeach()
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
  install(FILES ${directory}/copyright DESTINATION share/doc/${package} COMPONENT ${component})
  install(FILES ${directory}/changelog ${PROJECT_SOURCE_DIR}/CHANGELOG.md DESTINATION share/doc/${package}
    COMPONENT ${component})
endfunction()

set(what "Soapfilm fits a minimal surface to the samples of 3D scans by certified
continuous global optimization: closed objects come out watertight, each
surface with a proved bound of its distance from the global optimum.")

# A minor version before 1.0 may break the interface: it has a soname, and so a package, of its own.
set(soname ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(library libsoapfilm${soname})
debian_package(library ${library} libs "watertight surfaces from raw 3D scans (shared library)" "${what}
.
This package has the shared library.")
file(WRITE ${PROJECT_BINARY_DIR}/debian/shlibs "libsoapfilm ${soname} ${library} (>= ${soname})\n")
file(WRITE ${PROJECT_BINARY_DIR}/debian/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/debian/shlibs
  ${PROJECT_BINARY_DIR}/debian/triggers)

debian_package(development libsoapfilm-dev libdevel "watertight surfaces from raw 3D scans (headers)" "${what}
.
This package has the headers of the C++ and C interfaces, and what CMake
and pkg-config need to find the library.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)

debian_package(program soapfilm science "watertight surfaces from raw 3D scans" "${what}
.
This package has the program: it reads E57, PTX, PCD, LAS, LAZ, PLY, text
and more, reconstructs meshes, judges them against a truth, makes virtual scans
and draws pictures.")
set(CPACK_DEBIAN_PROGRAM_PACKAGE_RECOMMENDS libproj25)  # loaded for georeferenced tilesets: cli/proj_library.h

# The guides and the reference beside the program, without the pictures of measurements.
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/guide ${PROJECT_SOURCE_DIR}/docs/reference DESTINATION share/doc/soapfilm
  COMPONENT program FILES_MATCHING PATTERN "*.md" PATTERN "*.py" PATTERN "*.jpg" PATTERN "*.png")

# The program for many machines, where it is built (SOAPFILM_MPI).
if(TARGET soapfilm_mpi_cli)
  debian_package(mpi soapfilm-mpi science "watertight surfaces from raw 3D scans (Open MPI)" "${what}
.
This package has the program for runs on many machines, which mpirun starts.")
  set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS openmpi-bin)
endif()

# The Python package, where it is built (SOAPFILM_BUILD_PYTHON): its module is for one version of Python.
if(TARGET soapfilm_python)
  find_package(Python REQUIRED COMPONENTS Interpreter)
  math(EXPR next "${Python_VERSION_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next}~), python3-numpy")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${directory}/python/postinst ${directory}/python/prerm)
  set(modules lib/python3/dist-packages)
  install(TARGETS soapfilm_python LIBRARY DESTINATION ${modules}/soapfilm COMPONENT python)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/python/soapfilm DESTINATION ${modules} COMPONENT python
    FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN py.typed PATTERN __pycache__ EXCLUDE)
  debian_package(python python3-soapfilm python "watertight surfaces from raw 3D scans (Python module)" "${what}
.
This package has the module for Python 3.")
endif()
include(CPack)
