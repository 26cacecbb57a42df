#!/usr/bin/env bash
# Every table of [radecki2016] beside simulated encounters, the long form: perception-study paper with more trials of each
# scenario in each weather; an urban drive of seven minutes in the four weathers; pairs of pictures of what weather is known
# for, before and after. Everything is simulated. Leaves OUT/report.md with its tables as CSV, OUT/drive/report.md and
# OUT/pictures/*.png; logs of the drive (some GB) are removed. The drive takes about two hours of processor time, the
# pictures one minute.
#   tests/bench/paper/paper.sh [OUT, default out/paper] [options of perception-study paper, e.g. --seed 2]
#   PARTS="tables drive pictures"  TRIALS=20  DRIVE_SECONDS=420  DRIVE_WEATHERS="sunny night"  PERCEPTION_BIN=build/bin
set -euo pipefail
if [[ ${1:-} == -h || ${1:-} == --help ]]; then
  sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0"
  exit
fi
cd "$(dirname "$(readlink -f "$0")")/../../.."
out=${1:-out/paper}
shift || true
parts=${PARTS:-tables drive pictures}
readonly bin=${PERCEPTION_BIN:-build/bin}
mkdir -p "$out"

# Warnings (exit code 3) are no failure.
quietly() {
  local code=0
  "$@" >"$out/last.log" 2>&1 || code=$?
  ((code == 0 || code == 3)) || { cat "$out/last.log" >&2; return "$code"; }
}
# track LOG RUN INI SENSORS settings...
track() {
  local log=$1 run=$2 ini=$3 sensors=$4 set=() s
  shift 4
  for s in "$@"; do set+=(--set "$s"); done
  quietly "$bin/perception-track" -c "$ini" -i "$log" -o "$run" --overwrite --sensors "$sensors" ${set[@]+"${set[@]}"}
}

drive() {
  local weather sensors runs=$out/drive
  mkdir -p "$runs"
  echo condition,run,truth >"$runs/runs.csv"
  for weather in ${DRIVE_WEATHERS:-sunny night wet_cloudy snow_rain}; do
    quietly "$bin/perception-simulate" -c ini/scenarios/urban_drive.ini --weather "ini/weather/$weather.ini" \
      --set "scenario.duration=${DRIVE_SECONDS:-420}" -o "$runs/$weather.rawlog"
    for sensors in C+L+R L+R C+R; do
      track "$runs/$weather.rawlog" "$runs/$weather-$sensors" ini/skynet_shapes.ini "$sensors"
      echo "$weather $sensors,$weather-$sensors,$weather.truth.csv" >>"$runs/runs.csv"
    done
    rm "$runs/$weather.rawlog"
  done
  quietly "$bin/perception-evaluate" --manifest "$runs/runs.csv" -o "$runs" --no-plots
}

# pair NAME SCENARIO TIME INI RANGE VIEW "title A" "settings A" "title B" "settings B": both runs of one log, side by side
pair() {
  local name=$1 scenario=$2 time=$3 ini=$4 range=$5 view=$6 dir=$out/pictures
  local log=$dir/$scenario.rawlog
  [[ -f $log ]] || quietly "$bin/perception-simulate" -c "ini/scenarios/$scenario.ini" --set "scenario.duration=$time" -o "$log"
  # shellcheck disable=SC2086
  track "$log" "$dir/$name-before" "$ini" L $8
  # shellcheck disable=SC2086
  track "$log" "$dir/$name-after" "$ini" L ${10}
  quietly "$bin/perception-snapshot" -i "$log" -r "$dir/$name-before" -r "$dir/$name-after" --title "$7" --title "$9" --time "$time" \
    --range "$range" --view "$view" -o "$dir/$name.png"
}
pictures() {
  local dir=$out/pictures off=weather.filter=off r
  mkdir -p "$dir"
  pair spray slush 8 ini/kitti.ini 30 both "no trust of returns" $off "trust" ""
  pair plume exhaust 8 ini/kitti.ini 30 both "no trust of returns" $off "trust" ""
  pair mirror wet_parking 8 ini/kitti.ini 25 both "no trust of returns" $off "trust" ""
  pair snow_grid snowfall 8 ini/kitti.ini 20 top "grid without trust" $off "grid with trust" ""
  # The camera of 2k and 8k: the same street, people and cars found in each.
  for r in 2k 8k; do
    quietly "$bin/perception-simulate" -c ini/scenarios/busy_street.ini --set scenario.duration=6 \
      --set "sensor.CAMERA_PANO.resolution=$r" -o "$dir/street_$r.rawlog"
    track "$dir/street_$r.rawlog" "$dir/run_$r" ini/skynet.ini C+R "sensor.CAMERA_PANO.resolution=$r"
    quietly "$bin/perception-snapshot" -i "$dir/street_$r.rawlog" -r "$dir/run_$r" --title "panorama of $r, C+R" --time 6 --range 70 --view top \
      -o "$dir/panorama_$r.png"
  done
}

for part in $parts; do
  case $part in
    tables)
      "$bin/perception-study" paper -o "$out" --trials "${TRIALS:-20}" --resolution-seconds 40 "$@"
      ;;
    drive | pictures) "$part" ;;
    *) echo "PARTS: expected tables, drive, pictures" >&2; exit 64 ;;
  esac
done
