#!/usr/bin/env bash
# The tree on Debian 13 (MRPT 2.14), by hand, as root, with debootstrap installed: tools/check_debian13.sh FOLDER
# makes a Debian 13 in FOLDER (debootstrap) or takes the one that is there, builds a copy of the committed tree in it, runs all tests
# and the demo. Without clang-format and clang-tidy, whose versions are Debian 12's.
set -euo pipefail
(( $# == 1 )) || { echo "usage: $0 FOLDER" >&2; exit 64; }
source=$(dirname "$(dirname "$(readlink -f "$0")")") root=$1

if [[ ! -e $root/etc/debian_version ]]; then
  debootstrap --variant=minbase trixie "$root" http://deb.debian.org/debian >/dev/null
fi
cp /etc/resolv.conf "$root/etc/"
mount -t proc proc "$root/proc"
mount --bind /dev "$root/dev"
trap 'umount "$root/dev" "$root/proc"' EXIT
mkdir -p "$root/src"
git -C "$source" archive HEAD | tar -x -C "$root/src"

names=$(sed -n '/^packages=(/,/^)/p;/^test_packages=(/,/^)/p' "$source/setup.sh" |
  sed 's/#.*//; s/^.*packages=(//; s/^)//; s/clang-[a-z]*-14//g' | tr '\n' ' ')
chroot "$root" /bin/bash -euo pipefail -s <<INSIDE
export DEBIAN_FRONTEND=noninteractive
apt-get -q update >/dev/null
apt-get install -y -q --no-install-recommends ccache $names >/root/install.log
cd /src
export CMAKE_CXX_COMPILER_LAUNCHER=ccache LOCPATH=/src/build/locale
cmake --preset release -DPERCEPTION_TESTS=ON >/root/cmake.log
cmake --build --preset release -j "\$(nproc)" >/root/build.log
mkdir -p build/locale
localedef -i de_DE -f UTF-8 build/locale/de_DE.UTF-8 || true
PERCEPTION_DATA=. PATH=/src/build/bin:\$PATH apps/perception-demo/perception-demo out/demo | tail -n 8
ctest --preset release -j "\$(nproc)"
INSIDE
