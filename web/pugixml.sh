#!/bin/sh
# pugixml.sh FOLDER: the source of pugixml, of which Debian's package has only the compiled library, unpacked into FOLDER.
# Asks Debian's server by apt, which checks the signatures; changes nothing of the system.
set -eu
out=$1
[ -f "$out/src/pugixml.cpp" ] && exit 0
mkdir -p "$out/lists/partial" "$out/archives/partial"
out=$(realpath "$out")
cd "$out"
. /etc/os-release
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
echo "deb-src [signed-by=$keyring] http://deb.debian.org/debian $VERSION_CODENAME main" \
  >sources.list
apt="apt-get -q -o Dir::Etc::SourceList=$out/sources.list -o Dir::Etc::SourceParts=/dev/null
  -o Dir::State::Lists=$out/lists
  -o Dir::Cache::Archives=$out/archives -o APT::Sandbox::User=root"
$apt update >apt.txt
$apt source --download-only pugixml >>apt.txt
tar -xf pugixml_*.orig.tar.* --strip-components=1
[ -f src/pugixml.cpp ]
