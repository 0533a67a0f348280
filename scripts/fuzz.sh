#!/bin/sh
# fuzz.sh [SECONDS] [TARGET]: fuzzes a reader of files, scene or checkpoint (300 s, scene), with libFuzzer, AddressSanitizer
# and UBSan, by two processes. Inputs that reach code no other does join tests/fuzz/corpus/TARGET; one that fails stays in
# build-fuzz/found.
set -eu
cd "$(dirname "$0")/.."
seconds=${1:-300}
target=${2:-scene}
corpus=$PWD/tests/fuzz/corpus/$target
[ -d "$corpus" ] || { echo "fuzz.sh: no target '$target'; there are:" && ls tests/fuzz/corpus && exit 2; }

. ./scripts/install.sh
install_missing clang libclang-rt-14-dev

work=$PWD/build-fuzz
mkdir -p "$work/found" "$work/$target"
cmake -S . -B "$work" -DCMAKE_C_COMPILER=clang -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS=-O1 -DMPMSTAB_NATIVE=OFF \
  -DMPMSTAB_SANITIZE=ON -DMPMSTAB_FUZZ=ON >"$work/setup.log" 2>&1 || { cat "$work/setup.log"; exit 1; }
cmake --build "$work" --parallel 2 --target "fuzz_$target" >>"$work/setup.log" 2>&1 || { cat "$work/setup.log"; exit 1; }

. ./scripts/mpi-env.sh
export UBSAN_OPTIONS=halt_on_error=1
export ASAN_OPTIONS=quarantine_size_mb=16 # HDF5 asks for much and gives it back, and new pages take longest
[ ! -w /dev/shm ] || export TMPDIR=/dev/shm # thousands of small files a second
TMPDIR=$(mktemp -d) # libFuzzer ends without what a program does at its exit, so that the targets' folders stay
export TMPDIR
trap 'rm -rf "$TMPDIR"' EXIT
fuzzer=$work/tests/fuzz/fuzz_$target
words=$work/words.dict
grep -ho '"[A-Za-z_0-9]\{2,\}"' src/scene/field*.c src/task/tasks.c src/scheme/*/*.c | sort -u >"$words"
cd "$work"
nice -n 10 "$fuzzer" -jobs=2 -workers=2 -max_total_time="$seconds" -max_len=4096 -malloc_limit_mb=256 -dict="$words" \
  -print_final_stats=1 -artifact_prefix="$work/found/" "$work/$target" "$corpus" >"fuzz-$target.log" 2>&1 || status=$?
grep -h 'number_of_executed_units\|^SUMMARY\|Test unit written' fuzz-*.log | sort -u
nice -n 10 "$fuzzer" -merge=1 -use_counters=0 "$corpus" "$work/$target" >merge.log 2>&1 || { tail -n 20 merge.log; exit 1; }
echo "corpus: $(find "$corpus" -type f | wc -l) files, $(cat "$corpus"/* | wc -c) bytes"
exit "${status:-0}"
