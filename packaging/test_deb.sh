#!/bin/sh
# test_deb.sh DEBS WORK: checks the licenses of what the packages in DEBS depend on, installs them into a fresh Debian
# 12 under WORK, and uses all of them there: the program, its manual pages and completion, CMake, pkg-config; then
# removes them. Needs root (chroot); without it the packages are unpacked and the program is run with this machine's
# libraries, which tests less, and says so.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
debs=$(cd "$1" && pwd)
mkdir -p "$2"
work=$(cd "$2" && pwd)
. "$here/fresh_debian.sh"

say "licenses of the dependencies"
for deb in "$debs"/*.deb; do
  name=$(dpkg-deb -f "$deb" Package)
  for package in $(dpkg-deb -f "$deb" Depends | tr ',|' '\n\n' | sed 's/ *(.*//; s/ //g'); do
    case $package in libsoapfilm* | python3 | python3-numpy) continue ;; esac
    license=$(awk -v package="$package" '$1 == package { $1 = ""; print substr($0, 2) }' "$here/licenses.txt")
    [ -n "$license" ] || die "$name depends on $package, which packaging/licenses.txt does not name"
    echo "$name: $package: $license"
  done
  dpkg-deb -c "$deb" | grep "usr/share/doc/$name/copyright" >/dev/null || die "$name has no copyright file"
done

say "manual pages"
rm -rf "$work/unpacked" && mkdir "$work/unpacked"
for deb in "$debs"/*.deb; do dpkg-deb -x "$deb" "$work/unpacked"; done
for page in "$work"/unpacked/usr/share/man/man1/*.1.gz; do
  gzip -dc "$page" > "$work/page.1"
  if command -v mandoc >/dev/null; then mandoc -T lint -W warning "$work/page.1"; fi
  echo "$(basename "$page"): $(wc -l < "$work/page.1") lines"
done

# What a user does first. $1: a command that runs the program where it was installed.
use_program() {
  $1 soapfilm --version
  $1 soapfilm -q scan knot -o scans --noise 0.1%
  $1 soapfilm info scans/scans.conf
  $1 soapfilm reconstruct scans/scans.conf --preview
  $1 soapfilm reconstruct scans/scans.conf --check --strict
  $1 soapfilm -q evaluate scans.mesh.ply --truth knot
  $1 soapfilm render scans.mesh.ply -o knot.png
}

if ! can_make_debian; then
  say "no root or no debootstrap: the program only, with this machine's libraries"
  rm -rf "$work/run" && mkdir "$work/run" && cd "$work/run"
  use_program "env PATH=$work/unpacked/usr/bin:$PATH"
  exit 0
fi

say "a fresh Debian 12"
make_debian "$work"
mkdir "$root/debs" && cp "$debs"/*.deb "$root/debs/"
# A list of files that no package made, to see what stays behind.
list() { (cd "$root" && find etc opt usr var/lib/soapfilm* -name '*soapfilm*' 2>/dev/null | sort); }

say "install the program: apt install ./soapfilm_*.deb"
install_there "the program" '/debs/soapfilm_*.deb'
use_program at_try
at_try bash -c 'source /usr/share/bash-completion/completions/soapfilm
  COMP_WORDS=(soapfilm reconstruct --meth) COMP_CWORD=2; _soapfilm; [[ ${COMPREPLY[0]} == --method ]]' ||
  die "completion does not work"

say "install the program for many machines: apt install ./soapfilm-mpi_*.deb"
install_there "the program for many machines" '/debs/soapfilm-mpi_*.deb'
for program in soapfilm-mpi soapfilm; do  # which goes on as the other one
  at_try mpirun --allow-run-as-root --oversubscribe -n 2 $program -q reconstruct scans/scans.conf -o ranks.ply
  cmp "$root/try/ranks.ply" "$root/try/scans.mesh.ply" || die "$program: two processes make another mesh"
  rm "$root/try/ranks.ply"
done

say "install the library: apt install ./libsoapfilm*.deb, with a compiler"
install_there "the library" '/debs/libsoapfilm*.deb g++ cmake make pkg-config'
inside ldconfig -p | grep libsoapfilm > /dev/null || die "the trigger did not call ldconfig"
version=$(inside dpkg-query -W -f '${Version}' libsoapfilm0.1)
cp -r "$here/../tests/consumer/cpp" "$here/../tests/consumer/c" "$root/try/"
for language in cpp c; do
  at_try cmake -S $language -B build-$language -D EXPECTED_VERSION="$version" > "$work/cmake.log" 2>&1 &&
    at_try cmake --build build-$language >> "$work/cmake.log" 2>&1 ||
    { tail -20 "$work/cmake.log" >&2; die "a project in $language cannot be built"; }
  at_try sh -c "cd build-$language && ./consumer"
done
# shellcheck disable=SC2016
at_try sh -c 'gcc c/*.c $(pkg-config --cflags --libs soapfilm) -lm -o by-pkg-config && ./by-pkg-config'
if ls "$debs"/python3-soapfilm_*.deb >/dev/null 2>&1; then
  say "install the Python module"
  install_there "the Python module" '/debs/python3-soapfilm_*.deb'
  at_try python3 -c 'import numpy, soapfilm
points = numpy.random.default_rng(1).normal(size=(20000, 3))
points /= numpy.linalg.norm(points, axis=1)[:, None]
result = soapfilm.reconstruct(points, points, voxel=0.05)
assert result.topology()["watertight"] and abs(result.volume - 4.19) < 0.05, result.volume
soapfilm.view(result, "sphere.html")
print("Python:", soapfilm.__version__, len(result.triangles), "triangles")'
fi

say "remove them"
inside sh -c 'apt-get purge -y "*soapfilm*"' >> "$work/apt.log" 2>&1
left=$(list)
[ -z "$left" ] || die "left behind: $left"
rm -rf "$root" "$work/unpacked"
say "all well"
