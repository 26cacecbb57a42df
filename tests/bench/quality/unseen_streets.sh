#!/usr/bin/env bash
# How good are lidar classes on streets that the shape model has not seen? Each labeled recording is tracked with a model that
# learned from the others and from simulated scenes ("blind"), and with the shipped one. A line a row with its figures, what is
# wanted, and "met", "MISSED", "shown" (no goal) or "not measured". Ends with 1 where a row is missed or not measured.
#   tests/bench/quality/unseen_streets.sh [-o OUT] [-s "1 2 3"] [-t SEED] [-l LAG] [ROW ...]
#     ROW  left_out kitti_0000 kitti_0000_camera aimotive drive_0052 drive_0052_camera wads argoverse kitti_object delft
#          headings; without one, all
#     -s   seeds of the tracker [1 2 3]   -t  seed of the training [1]: figures move with it, so look at several
#     -l   scenes LAG seconds late, by [run] output_lag, for logs that are processed afterwards [0: at once]
# An hour and a half on two cores, most of it training. Logs, models and runs stay in OUT [out/unseen_streets]: what is there is not made again.
# Delete OUT/runs after a change of the tracker, OUT/models after one of the segmentation or the descriptors.
# PERCEPTION_BIN: programs [build/bin]. PERCEPTION_SHARED: folder with data/ and models/ [../shared].
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../../.."
readonly rows="left_out kitti_0000 kitti_0000_camera aimotive drive_0052 drive_0052_camera wads argoverse kitti_object delft headings"
out=out/unseen_streets seeds="1 2 3" training=1 lag=0
while getopts o:s:t:l:h option; do
  case $option in
    o) out=$OPTARG ;;
    s) seeds=$OPTARG ;;
    t) training=$OPTARG ;;
    l) lag=$OPTARG ;;
    h) sed -n '2,/^set/{/^set/d;s/^# \{0,1\}//p}' "$0"; exit ;;
    *) exit 64 ;;
  esac
done
shift $((OPTIND - 1))
readonly out seeds training lag bin=${PERCEPTION_BIN:-build/bin} shared=${PERCEPTION_SHARED:-../shared}
readonly data=$shared/data models=$out/models/seed_$training tool=tests/bench/quality/unseen_streets.py
runs=$out/runs
[[ $lag == 0 ]] || runs=$out/runs_late_$lag
readonly runs
read -ra chosen <<<"${*:-$rows}"
for row in "${chosen[@]}"; do
  [[ " $rows " == *" $row "* ]] || { echo "unseen_streets.sh: no row \"$row\"; there are: $rows" >&2; exit 64; }
done
mkdir -p "$out/logs" "$runs" "$models"

# Warnings (exit code 3) are no failure.
quietly() {
  local code=0
  "$@" >"$out/last.log" 2>&1 || code=$?
  ((code == 0 || code == 3)) || { cat "$out/last.log" >&2; return "$code"; }
}

# made FILE COMMAND...: makes a log that is not there.
made() {
  local file=$1
  shift
  [[ -f $file ]] || quietly "$@" -o "$file"
}

# Recordings, simulated scenes and simulated weather on recordings; what each is for the training: LOG = whole angle of complete truth.
readonly recorded="kitti0000=90 kitti_object=90 av2=360 aimotive=360 vod=60 wads=360"
readonly simulated="sim_E=360 sim_crossing=360 sim_street_images=360 sim_busy_kitti=360 sim_wet_highway_own=360 aimotive_spray=360 kitti_object_snow_2.5=90"

logs() {
  local l=$out/logs k=$data/kitti_tracking scene frame
  [[ -d $data/kitti_lidar_seq0000 ]] || return 1
  made "$l/kitti0000.rawlog" "$bin/perception-import" kitti --calib "$k/calib/0000.txt" --poses "$k/velo_poses/0000.txt" \
    --lidar "$data/kitti_lidar_seq0000/velodyne_front120" --labels "$k/label_02/0000.txt" --last 99 --rate 9.66 \
    --detections "rrc:Car=$k/det_rrc/Car/0000.txt" --detections "rrc:Pedestrian=$k/det_rrc/Pedestrian/0000.txt"
  made "$l/kitti_object.rawlog" "$bin/perception-import" kitti-object --dir "$data/kitti_object_lidar" --repeat 10
  made "$l/av2.rawlog" "$bin/perception-import" av2 --dir "$data/av2_scans" --repeat 10
  made "$l/aimotive.rawlog" "$bin/perception-import" aimotive --dir "$data/aimotive"
  made "$l/vod.rawlog" "$bin/perception-import" vod --dir "$data/vod_radar" --repeat 10
  made "$l/wads.rawlog" "$bin/perception-import" wads --dir "$data/wads_snow"
  # KITTI object without the four frames of drive 0052, for models that judge this drive.
  mkdir -p "$out/object_less_0052"
  for frame in calib label_2; do ln -sfn "$(readlink -f "$data/kitti_object_lidar/$frame")" "$out/object_less_0052/$frame"; done
  mkdir -p "$out/object_less_0052/velodyne"
  for frame in "$data"/kitti_object_lidar/velodyne/0000*.bin.gz; do
    ln -sf "$(readlink -f "$frame")" "$out/object_less_0052/velodyne/"
  done
  made "$l/kitti_object_less_0052.rawlog" "$bin/perception-import" kitti-object --dir "$out/object_less_0052" --repeat 10
  for scene in E crossing street_images; do
    made "$l/sim_$scene.rawlog" "$bin/perception-simulate" -c "ini/scenarios/$scene.ini" --vehicle ini/vehicles/kitti.ini
  done
  made "$l/sim_busy_kitti.rawlog" "$bin/perception-simulate" -c ini/scenarios/busy_street.ini --vehicle ini/vehicles/kitti.ini \
    --set scenario.duration=30
  made "$l/sim_wet_highway_own.rawlog" "$bin/perception-simulate" -c ini/scenarios/wet_highway.ini
  made "$l/aimotive_spray.rawlog" "$bin/perception-simulate" weather -i "$l/aimotive.rawlog" -c ini/weather/spray.ini --seed 1
  made "$l/kitti_object_snow_2.5.rawlog" "$bin/perception-simulate" weather -i "$l/kitti_object.rawlog" -c ini/weather/snow_2.5.ini --seed 1
}

# What a model learns that has not seen LOG: sets $used, options of perception-calibrate.
others() {
  local left=$1 entry name files=() angles=()
  for entry in $recorded $simulated; do
    name=${entry%=*}
    [[ $left == drive_0052 && $name == kitti_object ]] && name=kitti_object_less_0052
    [[ $left == drive_0052 && $name == kitti_object_snow* ]] && continue
    [[ $name == "$left" || $name == "${left}_s"* ]] && continue
    files+=("$out/logs/$name.rawlog") angles+=("${entry#*=}")
  done
  used=(-c ini/kitti.ini -i "${files[@]}" --complete-fov-deg "${angles[@]}" --seed "$training")
}

# blind LOG: sets $model, which has not seen LOG
blind() {
  local used
  model=$models/without_$1/lidar_classes.json
  [[ -f $model ]] && return
  others "$1"
  quietly "$bin/perception-calibrate" lidar-classes "${used[@]}" --model-only -o "${model%/*}"
}

# track LOG INI SENSORS MODEL TAG settings...: every seed; the runs are $runs/TAG-SEED. MODEL: "shipped", or a file
track() {
  local in=$1 ini=$2 sensors=$3 with=$4 tag=$5 seed set=(--set "run.output_lag=$lag") s
  shift 5
  [[ $with == shipped ]] || set+=(--set "sensor.LIDAR_TOP.classifier.file=$(readlink -f "$with")")
  for s in "$@"; do set+=(--set "$s"); done
  for seed in $seeds; do
    [[ -f $runs/$tag-$seed/done.json ]] || quietly "$bin/perception-track" -c "$ini" -i "$in" -o "$runs/$tag-$seed" \
      --overwrite --sensors "$sensors" --seed "$seed" ${set[@]+"${set[@]}"}
  done
}

# evaluate TAG TRUTH RANGE options...: every seed; adds the reports to $found
evaluate() {
  local tag=$1 truth=$2 range=$3 seed
  shift 3
  for seed in $seeds; do
    quietly "$bin/perception-evaluate" -r "$runs/$tag-$seed" -t "$truth" --range "$range" "$@" --no-plots -o "$runs/$tag-$seed.$range"
    found+=("$runs/$tag-$seed.$range/report.json")
  done
}

# Both models of one log: both LOG INI SENSORS TAG RANGES options of perception-evaluate...; adds the reports to $found
both() {
  local name=$1 ini=$2 sensors=$3 tag=$4 ranges=$5 range model
  shift 5
  blind "$name"
  track "$out/logs/$name.rawlog" "$ini" "$sensors" shipped "$tag"
  track "$out/logs/$name.rawlog" "$ini" "$sensors" "$model" "$tag.blind"
  for range in $ranges; do
    evaluate "$tag" "$out/logs/$name.truth.csv" "$range" "$@"
    evaluate "$tag.blind" "$out/logs/$name.truth.csv" "$range" "$@"
  done
}

# Single clusters, each recording judged by a model that has not seen it.
left_out() {
  local used
  others none
  [[ -f $models/all/boxes.csv ]] || quietly "$bin/perception-calibrate" lidar-classes "${used[@]}" -o "$models/all"
  $tool left_out "$models/all"
}

kitti_0000() {
  local found=()
  both kitti0000 ini/kitti.ini L kitti0000-L "20 40" --fov-deg 80 --complete-fov-deg 80
  $tool kitti_0000 "${found[@]}"
}
kitti_0000_camera() {
  local found=()
  both kitti0000 ini/kitti.ini C+L kitti0000-CL "20 40" --fov-deg 80 --complete-fov-deg 80
  $tool kitti_0000_camera "${found[@]}"
}

aimotive() {
  local found=()
  both aimotive ini/aimotive.ini L+R aimotive-LR 80 --fov-deg 360
  both aimotive ini/aimotive.ini L aimotive-L 80 --fov-deg 360
  $tool aimotive "${found[@]}"
}

# Four frames of the drive are labeled. The truth of the scans from the first to the last of them: unseen_drive.py.
drive() {
  local sensors=$1 tag=$2 model run l=$out/logs names='Car=car, Truck=car, Bus=car, Pedestrian=person, Cyclist=person'
  made "$l/drive_0052_images.rawlog" "$bin/perception-import" kitti --calib "$data/kitti_tracking/calib/0000.txt" \
    --lidar "$data/kitti_cam_lidar_drive0052/velodyne_front120" --images "$data/kitti_cam_lidar_drive0052/image_02"
  [[ -f $l/drive_0052.rawlog ]] || PERCEPTION_MODELS=$shared/models quietly "$bin/perception-detect" -c ini/detectors/yolox.ini \
    -i "$l/drive_0052_images.rawlog" --label yolox -o "$l/drive_0052.rawlog"
  [[ -f $out/drive_0052.ini ]] || tests/bench/quality/unseen_drive.py ini "$(readlink -f ini/kitti.ini)" "$out/drive_0052.ini"
  blind drive_0052
  track "$l/drive_0052.rawlog" "$out/drive_0052.ini" "$sensors" "$model" "$tag.blind" ego.source=lidar
  run=$runs/$tag.blind-${seeds%% *}
  [[ -f $l/drive_0052.truth.csv ]] || tests/bench/quality/unseen_drive.py truth "$data/kitti_cam_lidar_drive0052/label_2" \
    "$data/kitti_tracking/calib/0000.txt" "$run/scenes.csv" "$l/drive_0052.truth.csv"
  evaluate "$tag.blind" "$l/drive_0052.truth.csv" 40 --fov-deg 80 --complete-fov-deg 80 --min-points 0 --any-truth
}
drive_0052() {
  local found=()
  drive L drive_0052-L
  $tool drive_0052 "${found[@]}"
}
drive_0052_camera() {
  local found=()
  drive C+L drive_0052-CL
  $tool drive_0052_camera "${found[@]}"
}

# The labels of the returns say which certain road users stand on one, and which groups of persons have an output.
wads() {
  local model found=() tag seed
  blind wads
  track "$out/logs/wads.rawlog" ini/wads.ini L shipped wads-L
  track "$out/logs/wads.rawlog" ini/wads.ini L "$model" wads-L.blind
  for tag in wads-L wads-L.blind; do for seed in $seeds; do found+=("$runs/$tag-$seed"); done; done
  $tool wads "$data/wads_snow" "${found[@]}"
}

argoverse() {
  local found=()
  both av2 ini/av2.ini L av2-L "20 40" --fov-deg 360
  $tool argoverse "${found[@]}"
}
kitti_object() {
  local found=()
  both kitti_object ini/kitti_object.ini L kitti_object-L 40 --fov-deg 80 --complete-fov-deg 80 --time-limit 0.001
  $tool kitti_object "${found[@]}"
}
delft() {
  local found=()
  both vod ini/vod.ini L vod-L 40 --fov-deg 60 --complete-fov-deg 60 --time-limit 0.001
  $tool delft "${found[@]}"
}

# Fronts of all recordings together, with the shipped model but for drive 0052.
headings() {
  local found=() kept=() path
  both kitti0000 ini/kitti.ini L kitti0000-L 40 --fov-deg 80 --complete-fov-deg 80
  both kitti0000 ini/kitti.ini C+L kitti0000-CL 40 --fov-deg 80 --complete-fov-deg 80
  both aimotive ini/aimotive.ini L aimotive-L 80 --fov-deg 360
  both aimotive ini/aimotive.ini L+R aimotive-LR 80 --fov-deg 360
  both av2 ini/av2.ini L av2-L 40 --fov-deg 360
  both vod ini/vod.ini L vod-L 40 --fov-deg 60 --complete-fov-deg 60 --time-limit 0.001
  drive L drive_0052-L
  drive C+L drive_0052-CL
  for path in "${found[@]}"; do
    [[ $path == *.blind-* && $path != *drive_0052* ]] || kept+=("$path")
  done
  $tool headings "${kept[@]}"
}

$tool head
if ! logs; then
  for row in "${chosen[@]}"; do $tool absent "$row" "$data/kitti_lidar_seq0000 and its neighbors"; done
  echo "Not measured: ${chosen[*]}."
  exit 1
fi
missed=()
for row in "${chosen[@]}"; do
  set +e
  (set -e; "$row")
  code=$?
  set -e
  ((code == 0)) || missed+=("$row")
  ((code < 2)) || echo "$row: a program failed with exit code $code, see above" >&2
done
((${#missed[@]} == 0)) || { echo "Missed or not measured: ${missed[*]}."; exit 1; }
