#!/usr/bin/env bash
# The three encounters of [radecki2016] by sensor set, simulated: scenarios A, B, C with five trials each, tracked and
# pooled over all instants as in the tables of [radecki2016], with recall and precision of the front ends. Leaves
# OUT/pooled/report.md and plots, with the published rows beside. C/H: the camera's headings as one wide Gaussian.
# About 7 minutes and 2 GB on four cores; SEEDS="51 52 53 54" draws the five trials four times over.
#   tests/bench/paper/scenarios.sh [OUT, default out/scenarios]
# The same in other weather, one pool for each, logs deleted as they are done, runs that are there kept:
#   WEATHERS="sunny night wet_cloudy snow_rain" CONFIG=ini/skynet_shapes.ini SETS="C+L+R L+R C+R" tests/bench/paper/scenarios.sh OUT
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../../.."
readonly seeds=${SEEDS:-1} weathers=${WEATHERS:-.} trials=${TRIALS:-1 2 3 4 5}
out=${1:-out/scenarios} bin=${PERCEPTION_BIN:-build/bin} config=${CONFIG:-ini/skynet.ini} sets=${SETS:-L+R C+R C/H+R C+L+R}
export out bin config sets
mkdir -p "$out"

encounter() { # SCENE SEED TRIAL WEATHER
  local log=$out/$1$3s$2 set run weather=() measurements=(--measurements)
  if [[ $4 != . ]]; then log=${log}_$4 weather=(--weather "ini/weather/$4.ini") measurements=(); fi
  for set in $sets; do
    run=${log}_${set//\//}
    [[ $4 != . && -f $run/done.json ]] && continue
    [[ -f $log.rawlog ]] || "$bin/perception-simulate" -c "ini/scenarios/$1.ini" --seed "$2" --trial "$3" "${weather[@]}" \
      --threads 1 -o "$log.rawlog" >"$log.log"
    "$bin/perception-track" -c "$config" -i "$log.rawlog" -o "$run" --overwrite --sensors "$set" "${measurements[@]}" \
      --threads 1 >"$run.log" 2>&1 || [[ $? == 3 ]] # 3: warnings
  done
  [[ $4 == . ]] || rm -f "$log.rawlog"
}
export -f encounter
for trial in $trials; do for weather in $weathers; do for scene in A B C; do for seed in $seeds; do
  echo "$scene $seed $trial $weather"
done; done; done; done | xargs -P "${JOBS:-$(nproc)}" -n 4 bash -euo pipefail -c 'encounter "$@"' encounter

for weather in $weathers; do
  suffix=${weather#.}
  suffix=${suffix:+_$suffix}
  runs=()
  for set in $sets; do runs+=(-r "$set=$out/*s*${suffix}_${set//\//}"); done
  case $weather in # its rows of [radecki2016]
    .) rows=(--paper sunny --paper pedestrian --paper vehicle) ;;
    wet_cloudy) rows=(--paper wet) ;;
    snow_rain) rows=(--paper snow) ;;
    *) rows=(--paper "$weather") ;;
  esac
  "$bin/perception-evaluate" "${runs[@]}" -t "$out/{log}.truth.csv" "${rows[@]}" -o "$out/pooled$suffix"
done
[[ $weathers != . ]] || "$bin/perception-evaluate" -r "A, B, C=$out/*s*_C+L+R" -t "$out/{log}.truth.csv" --no-plots -o "$out/front_ends" \
  --front-end LIDAR_TOP --front-end CAMERA_PANO --front-end 'RADAR_*' >"$out/front_ends.txt"
