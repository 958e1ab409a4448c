# cmake -D SOURCE= -D VERSION= -P recipes.cmake: the recipes under packaging/ build this version, and list the libraries
# that CMakeLists.txt looks for.
cmake_minimum_required(VERSION 3.25)
file(READ ${SOURCE}/CMakeLists.txt lists)
string(REGEX MATCHALL "find_package\\([A-Za-z0-9_]+" finds "${lists}")
list(TRANSFORM finds REPLACE "find_package\\(" "")

# What a library is called by vcpkg and by conda; "-": not needed there.
set(names
  Threads - -  Eigen3 eigen3 eigen  nanoflann nanoflann nanoflann  fmt fmt fmt
  nlohmann_json nlohmann-json nlohmann_json
  pugixml pugixml pugixml  TinyGLTF tinygltf tinygltf  hwy highway libhwy  Boost boost-graph libboost-headers
  TBB tbb tbb-devel  embree embree3 embree  PNG libpng libpng
  meshoptimizer meshoptimizer meshoptimizer  CLI11 cli11 cli11  proj proj proj)

file(READ ${SOURCE}/packaging/vcpkg/ports/soapfilm/vcpkg.json port)
string(JSON port_version GET "${port}" version)
file(READ ${SOURCE}/packaging/conda/meta.yaml conda)
if(NOT port_version STREQUAL VERSION)
  message(SEND_ERROR "packaging/vcpkg/ports/soapfilm/vcpkg.json: version ${port_version}, must be ${VERSION}")
endif()
if(NOT conda MATCHES "version = \"${VERSION}\"")
  message(SEND_ERROR "packaging/conda/meta.yaml: its version must be ${VERSION}")
endif()
foreach(library IN LISTS finds)
  list(FIND names ${library} at)
  if(at EQUAL -1)
    message(SEND_ERROR "tests/recipes.cmake does not know what ${library} is called by vcpkg and conda")
    continue()
  endif()
  math(EXPR at_vcpkg "${at} + 1")
  math(EXPR at_conda "${at} + 2")
  list(GET names ${at_vcpkg} by_vcpkg)
  list(GET names ${at_conda} by_conda)
  if(NOT by_vcpkg STREQUAL "-" AND NOT port MATCHES "\"${by_vcpkg}\"")
    message(SEND_ERROR "packaging/vcpkg/ports/soapfilm/vcpkg.json lacks ${by_vcpkg}")
  endif()
  if(NOT by_conda STREQUAL "-" AND NOT conda MATCHES "- ${by_conda}[ \n]")
    message(SEND_ERROR "packaging/conda/meta.yaml lacks ${by_conda}")
  endif()
endforeach()
