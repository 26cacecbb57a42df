#!/usr/bin/env bash
# The commands of README as a stranger meets them: on a bare Debian, from a fresh clone, with nothing that a developer installed.
#   tools/check_bare.sh [--suite bookworm|trixie] [--user] [--keep] COMMAND...
# COMMANDs are those of setup.sh (demo, test, "fuzz 2", ...), one after the other in the same system; the first that fails ends it. The
# clone lies in a path with a space. --user: as an ordinary user whose sudo asks nothing, else as root. --keep: the system stays, its folder
# is printed. Needs root and debootstrap. Prints wall and CPU minutes of each command.
set -euo pipefail
source=$(dirname "$(dirname "$(readlink -f "$0")")")
# shellcheck source=tools/bare_system.sh
source "$source/tools/bare_system.sh"

readonly usage="usage: $0 [--suite bookworm|trixie] [--user] [--keep] COMMAND...  (commands of setup.sh)"
bareWanting >/dev/null || { echo "$0: error: a bare system needs root and debootstrap; missing: $(bareWanting)" >&2; exit 69; }
bareNamespace "$0" "$@"

suite=bookworm user=root keep=0 commands=()
while (( $# )); do
  case $1 in
    --suite) suite=${2:?$usage}; shift ;;
    --user) user=stranger ;;
    --keep) keep=1 ;;
    -*) echo "$usage" >&2; exit 64 ;;
    *) commands+=("$1") ;;
  esac
  shift
done
(( ${#commands[@]} )) || { echo "$usage" >&2; exit 64; }

bare_root=""
trap 'rm -f "${spent:-}" "${spent:-}.before"; (( keep )) && echo "bare system kept: $bare_root" || bareRemove' EXIT
trap 'exit 130' INT TERM
TIMEFORMAT='%0R s'
echo "== Making a bare Debian ($suite), a minute where none is kept"
time bareMake "$suite"
readonly folder="srv/stranger/all weather/perception"
bareClone "$source" "$folder"
if [[ $user != root ]]; then
  bareRun apt-get -q update >/dev/null
  bareRun apt-get -q -y install --no-install-recommends sudo >/dev/null
  bareRun useradd --shell /bin/bash --home-dir "/srv/$user" "$user"
  echo "$user ALL=(ALL) NOPASSWD: ALL" >"$bare_root/etc/sudoers.d/$user"
  bareRun chown -R "$user:" /srv/stranger
fi

summary="" code=0
spent=$(mktemp)
for command in "${commands[@]}"; do
  echo "== Bare Debian ($suite), as $user: ./setup.sh $command"
  began=$EPOCHREALTIME
  times >"$spent.before"
  if [[ $user == root ]]; then run=(bareRun); else run=(bareRunAs "$user"); fi
  # shellcheck disable=SC2016,SC2086  # the words of a command are arguments: "fuzz 2"
  "${run[@]}" bash -c 'cd "$1" && shift && exec ./setup.sh "$@"' bash "/$folder" $command || code=$?
  times >"$spent"
  # The second line of `times` is what the children took: 1m2.3s of the user, 0m4.5s of the system.
  summary+=$(awk -F '[ ms]+' -v a="$began" -v b="$EPOCHREALTIME" -v name="bare $suite, ./setup.sh $command" -v code="$code" '
    FNR == 2 { sign = NR == 2 ? -1 : 1; cpu += sign * ($1 + $3 + ($2 + $4) / 60) }
    END { printf "%s: %.1f min, %.1f min of CPU, %s", name, (b - a) / 60, cpu, code ? "FAILED with " code : "passed" }
    ' "$spent.before" "$spent")$'\n'
  (( code == 0 )) || break
done
printf '\n== Commands on the bare system\n%s' "$summary"
exit "$code"
