#!/bin/sh
# packages.sh GROUP...: installs what is missing of these groups of packages.txt, as root or through sudo; where
# neither is possible it prints the one line to run and fails. Costs nothing when all is there.
set -eu
list=$(dirname "$0")/packages.txt

if ! command -v dpkg-query >/dev/null; then
  echo "packages.sh: not a Debian system; $list names what is needed" >&2
  exit 0
fi

wanted=$(for group; do awk -v group="$group" '$1 == group { print $2 }' "$list"; done)
installed=$(dpkg-query --show --showformat '${db:Status-Abbrev} ${Package}\n' $wanted 2>/dev/null |
  sed -n 's/^.i. *//p')
missing=
for package in $wanted; do
  printf '%s\n' "$installed" | grep -qxF "$package" && continue
  # A newer node than Debian's brings npm along, and Debian's package would not go with it.
  case $package in nodejs) program=node ;; npm) program=npm ;; *) program= ;; esac
  [ -n "$program" ] && command -v "$program" >/dev/null || missing="$missing $package"
done
[ -n "$missing" ] || exit 0

install="apt-get update && apt-get install -o DPkg::Lock::Timeout=300 -y --no-install-recommends$missing"
if [ "$(id -u)" = 0 ]; then
  as_root=
elif sudo -n true 2>/dev/null; then
  as_root='sudo -n'
else
  echo "Debian packages are missing. Please run this line, then make again:" >&2
  echo "  sudo sh -c '$install'" >&2
  exit 1
fi
echo "Installing Debian packages:$missing"
$as_root env DEBIAN_FRONTEND=noninteractive sh -c "$install"
