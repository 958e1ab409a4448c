#!/bin/sh
# demo.sh PROGRAM FOLDER: from raw scans to a watertight mesh with a proof, all of it made here.
set -eu
program=$1
out=$2

mkdir -p "$out"
echo "1. A virtual scanner looks at a sharp-edged part from all around: $out/scans"
"$program" scan part -o "$out/scans"
echo "2. The raw scans become a mesh: $out/part.ply"
"$program" reconstruct "$out/scans/scans.conf" -o "$out/part.ply" --report "$out/report.json" --check
echo "3. The truth and the mesh side by side: $out/part.png"
"$program" render "$out/scans/truth.ply" "$out/part.ply" -o "$out/part.png"
echo "Done. Look at $out/part.png; the proof is in $out/report.json."
