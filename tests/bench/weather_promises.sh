#!/usr/bin/env bash
# What the project promises of bad weather, measured again: a line a row with its figure, what is wanted, and "met", "MISSED"
# or "not measured". Ends with 1 where a row is not met or not measured. Everything but the recordings is simulated, and the
# weather on recordings is, too; a row says so.
#   tests/bench/weather_promises.sh [-o OUT] [-s "1 2 3"] [-l LAG] [ROW ...]
#     ROW  health spray exhaust phantoms blown_snow rain snow camera_radar clutter fog town street realism; without one, all
#     -s   seeds of the simulated scenes and of the weather; "own": as the scene's INI has it [own]
#     -l   scenes LAG seconds late, by [run] output_lag, for logs that are processed afterwards [0: at once]: for tracks. Stops,
#          health, rates, realism and camera_radar are those at once
# Logs and runs stay in OUT [out/weather_promises]: what is there is not made again. Delete OUT/runs after a change of the tracker.
# PERCEPTION_BIN: programs [build/bin]. PERCEPTION_BENCH_BIN: blind_sensor_study [build-bench/bin]. PERCEPTION_SHARED: folder
# with data/ [../shared]; RECORDINGS: more clear recordings for `health`, INI=LOG each.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../.."
readonly rows="health spray exhaust phantoms blown_snow rain snow camera_radar clutter fog town street realism"
out=out/weather_promises seeds=own lag=0
while getopts o:s:l:h option; do
  case $option in
    o) out=$OPTARG ;;
    s) seeds=$OPTARG ;;
    l) lag=$OPTARG ;;
    h) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0"; exit ;;
    *) exit 64 ;;
  esac
done
shift $((OPTIND - 1))
readonly out seeds lag bin=${PERCEPTION_BIN:-build/bin} bench=${PERCEPTION_BENCH_BIN:-build-bench/bin}
readonly data=${PERCEPTION_SHARED:-../shared}/data
runs=$out/runs
[[ $lag == 0 ]] || runs=$out/runs_late_$lag
readonly runs
read -ra chosen <<<"${*:-$rows}"
for row in "${chosen[@]}"; do
  [[ " $rows " == *" $row "* ]] || { echo "weather_promises.sh: no row \"$row\"; there are: $rows" >&2; exit 64; }
done
mkdir -p "$out/logs" "$runs"

# Warnings (exit code 3) are no failure.
quietly() {
  local code=0
  "$@" >"$out/${row:-last}.log" 2>&1 || code=$?
  ((code == 0 || code == 3)) || { cat "$out/${row:-last}.log" >&2; return "$code"; }
}

# judge ROW FILE...: prints the row of the table; false where it is not met.
judge() { python3 tests/bench/weather_promises.py "$@"; }

absent() { # ROW what is missing
  python3 tests/bench/weather_promises.py --absent "$1" "$2"
}

# scene NAME SEED [options of perception-simulate]: makes the log, sets $log
scene() {
  local name=$1 seed=$2 of=()
  shift 2
  [[ $seed == own ]] || of=(--seed "$seed")
  log=$out/logs/${LOG_AS:-$name}_$seed.rawlog
  [[ -f $log ]] || quietly "$bin/perception-simulate" -c "ini/scenarios/$name.ini" ${of[@]+"${of[@]}"} "$@" -o "$log"
}

# track LOG RUN INI SENSORS settings...: sets $run
track() {
  local in=$1 ini=$3 sensors=$4 set=(--set "run.output_lag=$lag") s
  run=$runs/$2
  shift 4
  [[ ! -f $run/done.json ]] || return 0
  for s in "$@"; do set+=(--set "$s"); done
  quietly "$bin/perception-track" -c "$ini" -i "$in" -o "$run" --overwrite --sensors "$sensors" ${set[@]+"${set[@]}"}
}

# evaluate RUN TRUTH options...: leaves RUN.report/report.json
evaluate() {
  local tracked=$1 truth=$2
  shift 2
  quietly "$bin/perception-evaluate" -r "$tracked" -t "$truth" "$@" --no-plots -o "$tracked.report"
}

# The recorded drive KITTI 0000; false where it is not there.
kitti0000() {
  local k=$data/kitti_tracking
  log=$out/logs/kitti0000.rawlog
  [[ -f $log ]] && return 0
  [[ -d $data/kitti_lidar_seq0000 ]] || return 1
  quietly "$bin/perception-import" kitti --calib "$k/calib/0000.txt" --poses "$k/velo_poses/0000.txt" \
    --lidar "$data/kitti_lidar_seq0000/velodyne_front120" --labels "$k/label_02/0000.txt" --last 99 --rate 9.66 \
    --detections "rrc:Car=$k/det_rrc/Car/0000.txt" --detections "rrc:Pedestrian=$k/det_rrc/Pedestrian/0000.txt" -o "$log"
}

# 1. Each camera and radar blind, and each frozen, from three instants on; no sensor named in a clear recording.
health() {
  local study=$bench/blind_sensor_study found=() entry ini
  [[ -x $study ]] || { absent health "$study, built by ./setup.sh bench"; return; }
  kitti0000 || { absent health "$data/kitti_lidar_seq0000"; return; }
  local clear=$log
  scene A own --trial 3
  [[ -f $out/blind.txt ]] || "$study" "$log" ini/skynet_shapes.ini - 3 11 17 blind frozen >"$out/blind.txt"
  for entry in "ini/kitti.ini=$clear" "ini/demo.ini=rawlogs/demo.rawlog" ${RECORDINGS:-}; do
    ini=${entry%%=*}
    track "${entry#*=}" "clear_$(basename "$entry" .rawlog)" "$ini" C+L+R
    found+=("$run/events.jsonl")
  done
  judge health "$out/blind.txt" "${found[@]}"
}

# Drives behind a car in its spray, their stops and tracks on phantoms: leaves $out/safety_SCENE_SEED.
safety() {
  local name=$1 seed=$2
  scene "$name" "$seed"
  [[ -f $runs/safety_${name}_$seed/report.md ]] || quietly "$bin/perception-study" safety -i "$log" -c ini/kitti.ini \
    --set run.sensors=L --set "run.output_lag=$lag" -o "$runs/safety_${name}_$seed"
  studies+=("$runs/safety_${name}_$seed")
}

# 2. False stops.
spray() {
  local studies=() name seed
  for seed in $seeds; do for name in slush snowfall wet_highway; do safety "$name" "$seed"; done; done
  judge spray "${studies[@]}"
}

# 3. Class and length of the cars in their own cloud, by lidar, within 40 m.
exhaust() {
  local found=() name seed
  for seed in $seeds; do for name in exhaust slush; do
    scene "$name" "$seed"
    track "$log" "${name}_$seed" ini/kitti.ini L
    evaluate "$run" "${log%.rawlog}.truth.csv" --range 40
    found+=("$run" "${log%.rawlog}.truth.csv")
  done; done
  judge exhaust "${found[@]}"
}

# 4. Tracks on phantoms.
phantoms() {
  local studies=() name seed
  for seed in $seeds; do for name in slush snowfall exhaust wet_parking; do safety "$name" "$seed"; done; done
  judge phantoms "${studies[@]}"
}

# 5. The vehicle ahead in the snow that it blows up.
blown_snow() {
  local found=() seed
  for seed in $seeds; do
    scene snowfall "$seed"
    track "$log" "snowfall_$seed" ini/kitti.ini L
    evaluate "$run" "${log%.rawlog}.truth.csv" --range 40
    found+=("$run.report/report.json")
  done
  judge blown_snow "${found[@]}"
}

# Rates of rain and snow: the second generator on a recorded drive and on a simulated one.
rates() {
  local row=$1 seed found=()
  kitti0000 || { absent "$row" "$data/kitti_lidar_seq0000"; return; }
  for seed in $seeds; do
    local to=$runs/weather_$seed
    [[ $seed == own ]] && seed=1
    [[ -f $to/report.md ]] || quietly "$bin/perception-study" weather --seed "$seed" -o "$to" \
      --through "ini/kitti.ini=$log" ini/kitti.ini=ini/scenarios/slush.ini
    found+=("$to")
  done
  judge "$row" "${found[@]}"
}
# 6, 7.
rain() { rates rain; }
snow() { rates snow; }

# 8. Encounters A, B, C, five trials, in snow and rain without lidar.
camera_radar() {
  local seed
  seed=${seeds//own/1}
  [[ -f $runs/encounters/pooled_snow_rain/report.json ]] || SEEDS=$seed WEATHERS=snow_rain SETS=C+R CONFIG=ini/skynet_shapes.ini \
    PERCEPTION_BIN=$bin quietly tests/bench/paper/scenarios.sh "$runs/encounters"
  judge camera_radar "$runs/encounters/pooled_snow_rain/report.json"
}

# 9. Clutter of the roof lidar and of the radars configured ten times too low and too high; judged from 20 s on.
clutter() {
  local seed factor found=() set label rate radars=()
  mapfile -t radars < <(sed -n 's/^\[sensor\.\(RADAR_[0-9]*\)\]$/\1/p' ini/skynet.ini | sort -u)
  for seed in $seeds; do for factor in 0.1 1 10; do
    scene busy_street "$seed"
    set=()
    for label in LIDAR_TOP "${radars[@]}"; do
      rate=$(sed -n "/^\[sensor\.$label\]/,/^\[/s/^clutter_per_scan *= *\([0-9.]*\).*/\1/p" ini/skynet_shapes.ini ini/skynet.ini | head -n 1)
      [[ -z $rate ]] || set+=("sensor.$label.clutter_per_scan=$(awk -v r="$rate" -v f="$factor" 'BEGIN { print r * f }')")
    done
    track "$log" "clutter_${seed}_$factor" ini/skynet_shapes.ini L+R "${set[@]}"
    evaluate "$run" "${log%.rawlog}.truth.csv" --range 20 --fov-deg 360
    found+=("$run.report/instants.csv")
  done; done
  judge clutter "${found[@]}"
}

# 10. Fog of 50 m on the recorded drive.
fog() {
  local seed found=()
  for seed in $seeds; do
    kitti0000 || { absent fog "$data/kitti_lidar_seq0000"; return; }
    local clear=$log number=${seed//own/1}
    log=$out/logs/kitti0000_fog_$seed.rawlog
    [[ -f $log ]] || quietly "$bin/perception-simulate" weather -i "$clear" -c ini/weather/fog_50.ini -o "$log" --seed "$number"
    track "$log" "kitti0000_fog_$seed" ini/kitti.ini L
    evaluate "$run" "${clear%.rawlog}.truth.csv" --any-truth --range 20 --fov-deg 80 --complete-fov-deg 80
    found+=("$run.report/report.json")
  done
  judge fog "${found[@]}"
}

# 11. Seven minutes of town in snow and rain: headings. The log takes longest to make, so it is begun beside the other rows.
town_log() { LOG_AS=town scene urban_drive own --weather ini/weather/snow_rain.ini; }
town() {
  local sensors found=()
  town_log
  for sensors in C+L+R L+R; do
    track "$log" "town_$sensors" ini/skynet_shapes.ini "$sensors"
    evaluate "$run" "${log%.rawlog}.truth.csv"
    found+=("$run.report/report.json")
  done
  judge town "${found[@]}"
}

# 12. The busy street by a camera of 8k, lidar and radars, as perception-study paper has it: 15 s.
street() {
  LOG_AS=street_8k scene busy_street 1 --set scenario.duration=15 --set sensor.CAMERA_PANO.resolution=8k
  track "$log" street_8k ini/skynet.ini C+L+R sensor.CAMERA_PANO.resolution=8k
  evaluate "$run" "${log%.rawlog}.truth.csv"
  judge street "$run.report/report.json"
}

# 13. A forest that tells simulated from recorded snow.
realism() {
  local wads=${WADS:-$out/logs/wads.rawlog}
  kitti0000 || { absent realism "$data/kitti_lidar_seq0000"; return; }
  local clear=$log
  log=$out/logs/kitti_snow_2.5_sizes.rawlog
  [[ -f $wads || -d $data/wads_snow ]] || { absent realism "$data/wads_snow"; return; }
  [[ -f $wads ]] || quietly "$bin/perception-import" wads --dir "$data/wads_snow" -o "$wads"
  [[ -f $log ]] || quietly "$bin/perception-simulate" weather -i "$clear" -c ini/weather/snow_2.5_sizes.ini -o "$log" --seed 1
  [[ -f $runs/realism/report.md ]] || quietly "$bin/perception-study" snow-realism -i "$wads" "$log" -o "$runs/realism"
  judge realism "$runs/realism"
}

python3 tests/bench/weather_promises.py --head
missed=() making_town=
if ((${#chosen[@]} > 1)) && [[ " ${chosen[*]} " == *" town "* ]]; then
  set -m  # a process group of its own, which ends with the script
  (row=town_log && town_log) &
  making_town=$!
  set +m
  trap 'kill -- "-$making_town" 2>/dev/null || true' EXIT
fi
for row in "${chosen[@]}"; do
  [[ $row != town || -z $making_town ]] || wait "$making_town" || true  # the row says what failed
  set +e
  (set -e; "$row")
  code=$?
  set -e
  ((code == 0)) || missed+=("$row")
  ((code < 2)) || echo "$row: a program failed with exit code $code, see above" >&2
done
((${#missed[@]} == 0)) || { echo "Not met or not measured: ${missed[*]}."; exit 1; }
