#!/usr/bin/env bash
# The three encounters of [radecki2016] by sensor set, simulated: scenarios A, B, C with five trials each, tracked and
# pooled over all instants as in the tables of [radecki2016], with recall and precision of the front ends. Leaves
# OUT/pooled/report.md and plots, with the published rows beside. C/H: the camera's headings as one wide Gaussian.
# About 7 minutes and 2 GB on four cores; SEEDS="51 52 53 54" draws the five trials four times over.
#   tests/bench/scenarios.sh [OUT, default out/scenarios]
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
readonly out=${1:-out/scenarios} bin=${PERCEPTION_BIN:-build/bin}
readonly seeds=${SEEDS:-1} trials="1 2 3 4 5" sets="L+R C+R C/H+R C+L+R"
export out bin
mkdir -p "$out"

for scene in A B C; do for seed in $seeds; do for trial in $trials; do echo "$scene $seed $trial"; done; done; done |
  xargs -P "$(nproc)" -n 3 bash -c 'log=$out/$0$2s$1; [[ -f $log.rawlog ]] ||
    "$bin/perception-simulate" -c "ini/scenarios/$0.ini" --seed "$1" --trial "$2" --threads 1 -o "$log.rawlog" >"$log.log"'

for log in "$out"/*.rawlog; do for set in $sets; do echo "$(basename "$log" .rawlog) $set"; done; done |
  xargs -P "$(nproc)" -n 2 bash -c 'run=$out/$0_${1//\//}; "$bin/perception-track" -c ini/skynet.ini -i "$out/$0.rawlog" -o "$run" --overwrite \
    --sensors "$1" --measurements --threads 1 >"$run.log" 2>&1'

runs=()
for set in $sets; do runs+=(-r "$set=$out/*s*_${set//\//}"); done
"$bin/perception-evaluate" "${runs[@]}" -t "$out/{log}.truth.csv" --paper sunny --paper pedestrian --paper vehicle -o "$out/pooled"
"$bin/perception-evaluate" -r "A, B, C=$out/*s*_C+L+R" -t "$out/{log}.truth.csv" --no-plots -o "$out/front_ends" \
  --front-end LIDAR_TOP --front-end CAMERA_PANO --front-end 'RADAR_*' >"$out/front_ends.txt"
