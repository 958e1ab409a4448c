#!/bin/sh
# Run by conda build, in a copy of the sources.
set -eu
cmake ${CMAKE_ARGS:-} -S . -B build/conda -G Ninja -D CMAKE_BUILD_TYPE=Release -D BUILD_SHARED_LIBS=ON \
  -D CMAKE_INSTALL_PREFIX="$PREFIX" -D CMAKE_INSTALL_LIBDIR=lib \
  -D SOAPFILM_BUILD_TESTS=OFF -D SOAPFILM_BUILD_EXAMPLES=OFF
cmake --build build/conda
cmake --install build/conda
