#!/bin/sh
# reference_bytes.sh PROGRAM [WORK]: the hashes of the meshes of some cases, made here. A change that shall not touch
# meshes leaves docs/notes/reference-bytes.txt as it is; one that shall, replaces it and says why in its message.
# Virtual scans use the C library's logarithm: hashes of the same machine count.
set -eu
program=$1
work=${2:-out/reference-bytes}
mkdir -p "$work"
cd "$work"
case $program in /*) ;; *) program=$OLDPWD/$program ;; esac

for object in sphere part knot arch; do
  [ -e $object ] || "$program" --quiet scan $object -o $object --noise 0.1% --image 120x120 --seed 3 --views 12
done
for object in room street terrain; do
  [ -e $object ] || "$program" --quiet scan $object -o $object --noise 0.1% --seed 3
done

hash() {
  name=$1
  shift
  "$program" --quiet reconstruct "$@" -o mesh.ply >log 2>&1 || { cat log >&2; exit 1; }
  printf '%s  %s\n' "$(sha256sum mesh.ply | cut -c 1-16)" "$name"
}

hash "sphere, 64 vertices" sphere/scans.conf --resolution 64
hash "part" part/scans.conf
hash "part, 160 vertices, unrefined" part/scans.conf --resolution 160 --refine off
hash "knot" knot/scans.conf
hash "knot, estimated directions" knot/scans.conf --directions estimate
hash "knot, cross-validated" knot/scans.conf --resolution 64 --lambda auto
hash "knot, poisson" knot/scans.conf --resolution 64 --method poisson
hash "knot, graph cut" knot/scans.conf --resolution 64 --method graph-cut-26
hash "knot, sor" knot/scans.conf --resolution 64 --method tv-sor
hash "knot, vrip" knot/scans.conf --resolution 64 --method vrip
hash "arch, curved holes" arch/scans.conf --holes smooth
hash "room" room/scans.conf --resolution 128
hash "street" street/scans.conf --resolution 200
hash "terrain" terrain/scans.conf --resolution 128
