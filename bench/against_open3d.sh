#!/bin/sh
# SPDX-FileCopyrightText: The pcavr authors
# SPDX-License-Identifier: Apache-2.0
#
# bench/against_open3d.sh RECORDING [TRUTH]
#
# Builds the comparison in build/bench and runs it: speed, memory and accuracy of pcavr's fusion
# and Open3D's, in one run. Measures CPU time, which depends little on other load; use an idle
# machine for accurate results. BUILD_DIR sets another build folder.
set -eu
[ $# -ge 1 ] || { echo "usage: $0 RECORDING [TRUTH]" >&2; exit 2; }
root=$(cd "$(dirname "$0")/.." && pwd)
build=${BUILD_DIR:-$root/build/bench}
if [ ! -f "$build/CMakeCache.txt" ]; then
  cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release >/dev/null
fi
cmake "$build" -DPCAVR_BUILD_BENCHMARKS=ON >/dev/null
cmake --build "$build" --target pcavr_bench_against_open3d >/dev/null || {
  echo "cannot build pcavr_bench_against_open3d: install libopen3d-dev" >&2
  exit 1
}
echo "commit   $(git -C "$root" describe --always --dirty)"
echo "compiler $(sed -n 's/^CMAKE_CXX_COMPILER:[^=]*=//p' "$build/CMakeCache.txt" | xargs -I{} sh -c '{} --version | head -1')"
echo "build    $(sed -n 's/^CMAKE_BUILD_TYPE:[^=]*=//p' "$build/CMakeCache.txt")"
echo "CPU      $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), $(nproc) cores"
echo "load     $(cut -d' ' -f1-3 /proc/loadavg)"
# One thread each: Open3D takes its count from OpenMP.
OMP_NUM_THREADS=1 exec "$build/bench/pcavr_bench_against_open3d" "$@"
