#!/bin/sh
# test_wheel.sh WHEEL WORK: installs the portable wheel into an empty environment in WORK and uses it there
# (wheel/try.py); as root the same in a fresh Debian 12, which has none of the libraries.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
wheel=$(realpath "$1")
mkdir -p "$2"
work=$(cd "$2" && pwd)
. "$here/fresh_debian.sh"

# Debian's pip and NumPy; soapfilm from the wheel. Nothing comes from a registry.
environment='/usr/bin/python3 -m venv --system-site-packages --without-pip venv'
install='venv/bin/python -m pip install --quiet --no-index'

say "an empty environment"
rm -rf "$work/venv" && cd "$work"
$environment
$install "$wheel"
module=$(ls venv/lib/python3*/site-packages/soapfilm/_core*.so)
ldd "$module"
if ldd "$module" | grep -E 'not found|(embree|tbb|fmt|hwy|png|pugixml|stb|tinygltf|meshopt).*=> /(usr/)?lib/'; then
  die "not from the wheel"
fi
venv/bin/python -B "$here/wheel/try.py"

if ! can_make_debian; then
  say "no root or no debootstrap: not tried in a fresh Debian"
  exit 0
fi
say "a fresh Debian 12"
make_debian "$work"
install_there "pip" "python3-pip python3-numpy"
cp "$wheel" "$here/wheel/try.py" "$root/try/"
[ -z "$(inside dpkg-query -W -f '${Package} ' 'libtbb*' 'libembree*' 'libfmt*' 'libpugixml*' 2>/dev/null)" ] ||
  die "the fresh Debian has the libraries"
at_try $environment
at_try $install "$(basename "$wheel")"
at_try venv/bin/python try.py
rm -rf "$root"
say "all well"
