#!/usr/bin/env bash
# [radecki2016]'s camera headings, split into axis and direction (C+R), beside one wide Gaussian (C/H+R): scenarios A, B
# and C with camera and radars alone, five trials of four seeds each (SEEDS="1 2" for others). Ten encounters, as in scenarios.sh,
# cannot tell the two apart. Leaves OUT/pooled/report.md. About two minutes on four cores.
#   tests/bench/paper/headings.sh [OUT, default out/headings]
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../../.."
readonly out=${1:-out/headings} bin=${PERCEPTION_BIN:-build/bin}
export out bin
mkdir -p "$out"

# [radecki2016]'s vehicle without its lidars.
awk '/^\[/ { keep = !/^\[sensor\.(LIDAR|IBEO)/ } keep' ini/vehicles/skynet.ini >"$out/vehicle.ini"

for scene in A B C; do for seed in ${SEEDS:-61 62 63 64}; do for trial in 1 2 3 4 5; do echo "$scene $seed $trial"; done; done; done |
  xargs -P "$(nproc)" -n 3 bash -c 'log=$out/$0$2s$1
    [[ -f $log.rawlog ]] || "$bin/perception-simulate" -c "ini/scenarios/$0.ini" --vehicle "$out/vehicle.ini" --seed "$1" \
      --trial "$2" --threads 1 -o "$log.rawlog" >"$log.log"
    for set in C+R C/H+R; do "$bin/perception-track" -c ini/skynet.ini -i "$log.rawlog" -o "${log}_${set//\//}" --overwrite --sensors "$set" \
      --threads 1 >>"$log.log" 2>&1; done'

"$bin/perception-evaluate" -r "C+R=$out/*_C+R" -r "C/H+R=$out/*_CH+R" -t "$out/{log}.truth.csv" --paper vehicle --no-plots \
  -o "$out/pooled"
