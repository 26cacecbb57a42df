#!/usr/bin/env bash
# Every table of [radecki2016] beside simulated encounters, the long form: perception-study paper with
# more trials of each scenario in each weather. Leaves OUT/report.md and its tables as CSV.
#   tests/bench/paper.sh [OUT, default out/paper] [options of perception-study paper, e.g. --seed 2]
#   TRIALS=20  PERCEPTION_BIN=build/bin
set -euo pipefail
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0"
  exit
fi
cd "$(dirname "$(readlink -f "$0")")/../.."
out=${1:-out/paper}
shift || true
"${PERCEPTION_BIN:-build/bin}/perception-study" paper -o "$out" --trials "${TRIALS:-20}" \
  --resolution-seconds 40 "$@"
