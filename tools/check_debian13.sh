#!/usr/bin/env bash
# README's two commands on a bare Debian 13 (CMake 3.31, MRPT 2.14), by hand, as root, with debootstrap installed.
exec "$(dirname "$(readlink -f "$0")")/check_bare.sh" --suite trixie demo test
