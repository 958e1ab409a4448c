#!/bin/sh
# fuzz/run.sh SECONDS [each|FORMAT...]: runs the fuzzers of build/asan for so long each, as many at once as there are cores
# (at most two). FORMAT: an extension such as .las, params or c_interface; default: all, the extensions as the program
# lists them; each: one extension of each reader, params and c_interface. Inputs that were found are kept in out/fuzz/, those that break something in out/fuzz/found/; then it fails.
set -u
cd "$(dirname "$0")/.." || exit 1
seconds=${1:?usage: fuzz/run.sh SECONDS [FORMAT...]}
shift
bin=build/asan/bin
out=out/fuzz
python=/usr/bin/python3
mkdir -p "$out/found" "$out/log"

formats=$("$bin/fuzz_readers" --formats) || exit 1
"$python" -B fuzz/seeds.py "$out/seeds" $formats || exit 1
mkdir -p "$out/seeds/params" "$out/seeds/c_interface"
"$bin/fuzz_params" --defaults >"$out/seeds/params/defaults.json" || exit 1
# Words of parameters are those of their defaults.
grep -o '"[a-z_0-9]*"' "$out/seeds/params/defaults.json" | sort -u >"$out/seeds/params.words"

# What an input may cost. No single allocation over 64 MB and 4 times the input (-malloc_limit_mb counts in MiB, the
# largest input is 64 KiB); all of the process, with AddressSanitizer's own memory, stays below -rss_limit_mb.
limits="-max_len=65536 -malloc_limit_mb=65 -rss_limit_mb=1024 -timeout=20"
export ASAN_OPTIONS="quarantine_size_mb=16:detect_leaks=1:allocator_may_return_null=0:${ASAN_OPTIONS:-}"
export UBSAN_OPTIONS="print_stacktrace=1:${UBSAN_OPTIONS:-}"

# One fuzzer; prints a line of what it did.
fuzz() {
  name=$1
  program=fuzz_readers words=fuzz/words.txt
  case $name in
    params) program=fuzz_params words=$out/seeds/params.words ;;
    c_interface) program=fuzz_c_interface words= ;;
  esac
  mkdir -p "$out/corpus/$name" "fuzz/regressions/$name" 2>/dev/null
  SOAPFILM_FUZZ_FORMAT=$name SOAPFILM_FUZZ_FOLDER=$out/seeds/beside "$bin/$program" -max_total_time="$seconds" $limits \
    ${words:+-dict=$words} -print_final_stats=1 -artifact_prefix="$out/found/in$name-" "$out/corpus/$name" \
    "$out/seeds/$name" "fuzz/regressions/$name" >"$out/log/$name" 2>&1 </dev/null
  code=$?
  rmdir "fuzz/regressions/$name" 2>/dev/null
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$out/log/$name")
  printf '%-12s %9s executions, %6s a second\n' "$name" "${runs:-?}" \
    "$(sed -n 's/^stat::average_exec_per_sec: *//p' "$out/log/$name")"
  if [ "$code" != 0 ]; then
    echo "$name: failed, see $out/log/$name:"
    grep -a -m 3 -E 'SOAPFILM_FUZZ_FORMAT|ERROR|broken law|SUMMARY|runtime error|Test unit written' "$out/log/$name"
    echo "$name" >>"$out/failed"
  fi
}

rm -f "$out/failed"
wanted=${*:-$formats params c_interface}
[ "$wanted" != each ] || wanted="$("$bin/fuzz_readers" --readers) params c_interface"
at_once=$(nproc)
[ "$at_once" -gt 2 ] && at_once=2
running=0
for name in $wanted; do
  fuzz "$name" &
  running=$((running + 1))
  if [ "$running" -ge "$at_once" ]; then
    wait
    running=0
  fi
done
wait
[ ! -e "$out/failed" ] || { echo "failed: $(tr '\n' ' ' <"$out/failed")"; exit 1; }
