#!/usr/bin/env bash
# The package on a bare Debian 12, by hand, as root, with debootstrap installed: tools/check_package.sh PACKAGE.deb
# installs the package, runs the demo and removes the package again. Prints the seconds of each, downloads apart, and what was
# left behind.
set -euo pipefail
source=$(dirname "$(dirname "$(readlink -f "$0")")")
# shellcheck source=tools/bare_system.sh
source "$source/tools/bare_system.sh"
(( $# == 1 )) && [[ -r $1 ]] || { echo "usage: $0 PACKAGE.deb" >&2; exit 64; }
bareWanting >/dev/null || { echo "$0: error: a bare system needs root and debootstrap; missing: $(bareWanting)" >&2; exit 69; }
bareNamespace "$0" "$@"

bare_root=""
trap bareRemove EXIT
bareMake bookworm
cp "$1" "$bare_root/root/"
bareRun bash -euo pipefail -s <<'INSIDE'
cd /root
export DEBIAN_FRONTEND=noninteractive
seconds() { local begin=$EPOCHREALTIME; "$@" >"$1.log" 2>&1 || { cat "$1.log" >&2; return 1; }; awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.1f s\n", b - a }'; }
files() { find / -xdev \( -path /proc -o -path /dev -o -path /tmp -o -path /root -o -path /var/cache -o -path /var/lib/apt -o -path /var/log \) -prune -o -print | sort; }
apt-get -q update >/dev/null
apt-get install -y -q --download-only ./perception*.deb >download.log
install() { apt-get install -y -q ./perception*.deb; }
demo() { perception-demo results; }
echo "packages before: $(dpkg -l | grep -c ^ii)"
files >before
echo "install: $(seconds install)"
echo "packages with it: $(dpkg -l | grep -c ^ii), $(dpkg-query -W -f='${Installed-Size}' perception) kB of them perception"
echo "demo: $(seconds demo)"
tail -n 8 demo.log
echo "options of perception-track that bash completes: $(. /usr/share/bash-completion/completions/perception-track 2>/dev/null
  COMP_WORDS=(perception-track --over) COMP_CWORD=1; _perception; echo "${COMPREPLY[@]}")"
gzip -dc /usr/share/man/man1/perception-track.1.gz | head -n 4
apt-get purge -y -q --autoremove perception >purge.log
files >after
echo "left behind, of perception: $(comm -13 before after | grep -c perception || true)"
INSIDE
