#!/bin/sh
# run.sh PROGRAMS FOLDER: runs the measuring programs. The kernels' page goes to bench/results/kernels.md; the other
# results are in FOLDER, and what of them is worth keeping goes to bench/results/ with this command.
# The whole program beside its peers is measured by bench/speed/speed.py.
set -eu
here=$(dirname "$0")
programs=$1
out=$2
mkdir -p "$out"
if [ -n "${SOAPFILM_DATA:-}" ]; then
  scans=$SOAPFILM_DATA/bunny/bun.conf
  set -- "$SOAPFILM_DATA/meshes/horse.ply" "$SOAPFILM_DATA/meshes/bunny_hr.obj" "$SOAPFILM_DATA/meshes/anchor.off"
else
  echo "SOAPFILM_DATA is not set: virtual scans instead of real ones"
  "$programs/soapfilm" scan knot -o "$out/scans" --noise 0.1% --quiet
  scans=$out/scans/scans.conf
  set --
fi
"$programs/bench_tolerance" "$scans" 256 | tee "$out/tolerance.md"
"$programs/bench_readers" | tee "$here/results/readers.md"
"$programs/bench_penalties" "$@" | tee "$out/penalties.md"
# Kernels and the copy beside them take turns; medians, for one run of one of them tells little.
for kernels in kernels kernels_refine kernels_io; do
  rm -f "$out/$kernels.json"
  "$programs/bench_$kernels" --benchmark_repetitions=9 --benchmark_enable_random_interleaving=true \
    --benchmark_report_aggregates_only=true --benchmark_out="$out/$kernels.json" --benchmark_out_format=json
done
/usr/bin/python3 -B "$here/kernels/kernels.py" "$out" "$here/results/kernels.md"
