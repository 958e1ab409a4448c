#!/bin/sh
# demo.sh PROGRAM FOLDER: from raw scans to a watertight mesh with a proof, all of it made here. The picture in the
# README is this one.
set -eu
program=$1
out=$2

mkdir -p "$out"
echo "1. A virtual scanner looks at a knot of genus 4 from 18 sides, with noise: $out/scans"
"$program" scan knot -o "$out/scans" --noise 0.1% --image 200x200 --seed 3
echo "2. The raw scans become a mesh: $out/knot.ply"
"$program" reconstruct "$out/scans/scans.conf" -o "$out/knot.ply" --report "$out/report.json" --check
echo "3. The scans and the mesh side by side: $out/knot.png"
"$program" render "$out/scans/scans.conf" "$out/knot.ply" --view 0.3,-0.4,1 --size 640x520 --shading smooth \
  --caption "raw virtual scans" --caption "soapfilm reconstruct" -o "$out/knot.png"
echo "4. Both in a page for the browser: $out/knot.html"
if "$program" --quiet view "$out/scans/scans.conf" "$out/knot.ply" --report "$out/report.json" --html "$out/knot.html" \
  --title "A knot of genus 4"; then page=", and at $out/knot.html in a browser"; else page=; fi
echo "Done. Look at $out/knot.png$page; the proof is in $out/report.json."
