#!/bin/sh
# build.sh BUILD OUT: the wheel of the Python package, made from the objects of BUILD, with what it links inside, into
# OUT (portable.py). For the version of Python that Debian has.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$1" && pwd)
rm -rf "$2" && mkdir -p "$2"
out=$(cd "$2" && pwd)
plain=$(mktemp -d)
trap 'rm -rf "$plain"' EXIT

SOAPFILM_BUILD_DIR=$build /usr/bin/python3 -m pip wheel --quiet --no-index --no-build-isolation --no-deps \
  --wheel-dir "$plain" "$root"
/usr/bin/python3 -B "$root/packaging/wheel/portable.py" "$plain"/*.whl "$out"
