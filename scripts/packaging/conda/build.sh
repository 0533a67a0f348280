#!/bin/sh
set -eu
# shellcheck disable=SC2086,SC2154 # conda sets these; CMAKE_ARGS is a list of words
cmake -S . -B build ${CMAKE_ARGS:-} -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$PREFIX" -DCMAKE_INSTALL_LIBDIR=lib \
  -DBUILD_SHARED_LIBS=ON -DMPMSTAB_NATIVE=OFF -DBUILD_TESTING=OFF
cmake --build build --parallel "$CPU_COUNT"
cmake --install build
