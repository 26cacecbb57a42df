#!/usr/bin/env bash
# Do figures without a truth follow the true errors? Tracks logs with truth (the demo and two scenarios, simulated; KITTI's
# sequence 0000 by its lidar, by lidar and camera; four sequences by PointRCNN's boxes) with the shipped settings and with
# spoiled ones, two seeds each, and prints the rank correlations: perception-evaluate --without-truth --manifest. Ten minutes
# on two cores. What follows with .6 or more is what users are shown (libperception/evaluation/without_truth/Quality.cpp).
# The figures were chosen on these logs; `held` are others: sequences of PointRCNN's and image boxes, a scenario (simulated).
#   tests/bench/quality/quality.sh [-o OUT] [held]
# PERCEPTION_SHARED: folder with data/ [../shared]; PERCEPTION_BIN: programs [build/bin]. Without data: simulated logs alone.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../../.."
out=out/quality
while getopts o: option; do case $option in o) out=$OPTARG ;; *) exit 64 ;; esac; done
shift $((OPTIND - 1))
scenes=(crossing stepping_out) sequences=(0004 0010 0011 0012) sets=(L) held=${1:-}
[[ -z $held ]] || { scenes=(busy_street) sequences=(0001 0005 0013 0014 0019) sets=(L C+L); }
readonly bin=${PERCEPTION_BIN:-build/bin} data=${PERCEPTION_SHARED:-../shared}/data
mkdir -p "$out/logs"
export bin out

# spoiled NAME settings...: noise, detection, false measurements, births, mounting, classes, association
lidar_settings() {
  local n=sensor.LIDAR_TOP
  cat <<END
good
noise_x4 $n.noise.car_sized.sigma_edge=1 $n.noise.car_sized.sigma_range=1 $n.noise.person_sized.sigma_edge=0.8 $n.noise.person_sized.sigma_range=0.8 $n.noise.unstable.sigma_edge=1 $n.noise.unstable.sigma_range=1
noise_:4 $n.noise.car_sized.sigma_edge=0.06 $n.noise.car_sized.sigma_range=0.06 $n.noise.person_sized.sigma_edge=0.05 $n.noise.person_sized.sigma_range=0.05 $n.noise.unstable.sigma_edge=0.06 $n.noise.unstable.sigma_range=0.06
clutter_x20 $n.clutter_per_scan=40
births_x40 $n.births_per_scan=20 $n.clutter_per_scan=0.1
coarse $n.clusters.near_threshold=1.2 $n.clusters.far_threshold=2
few_points $n.clusters.min_points=40
mounting $n.pose=0,0,1.73,8,0,0
accelerations class.car.accel_psd=40 class.pedestrian.accel_psd=20 class.cyclist.accel_psd=40
overconfident $n.label_exponent=1 $n.detection_exponent=1 filter.kinematic_exponent=1 filter.class_forgetting=1e6
nearest run.association=nearest particle_filter.sampleSize=1
low_detection $n.class.car.detection=0.2 $n.class.pedestrian.detection=0.2 $n.class.cyclist.detection=0.2
END
}
box_settings() {
  cat <<END
good
clutter_:40 sensor.pointrcnn.clutter_per_scan=0.1
clutter_x20 sensor.pointrcnn.clutter_per_scan=80
births_x40 sensor.pointrcnn.births_per_scan=4
low_detection sensor.pointrcnn.class.car.detection=0.3 sensor.pointrcnn.class.pedestrian.detection=0.3 sensor.pointrcnn.class.cyclist.detection=0.3
accelerations class.car.accel_psd=40 class.pedestrian.accel_psd=20 class.cyclist.accel_psd=40
all_output scene.min_existence=0.001 scene.place_within=0
nearest run.association=nearest particle_filter.sampleSize=1
END
}

# run LOG INI SENSORS NAME settings...: both seeds
run() {
  local log=$1 ini=$2 sensors=$3 name=$4 set=() seed code
  shift 4
  for s in "$@"; do set+=(--set "$s"); done
  for seed in 1 2; do
    code=0
    "$bin/perception-track" -c "$ini" -i "$out/logs/$log.rawlog" -o "$out/runs/$log-$sensors-$name-$seed" --overwrite --threads 1 \
      --sensors "$sensors" --seed "$seed" ${set[@]+"${set[@]}"} >"$out/run.log" 2>&1 || code=$?
    (( code == 0 || code == 3 )) || { cat "$out/run.log" >&2; return 1; }
    echo "$log-$sensors,runs/$log-$sensors-$name-$seed,logs/$log.truth.csv" >>"$out/runs.csv"
  done
}
series() {  # LOG INI SENSORS SETTINGS-FUNCTION
  local name rest
  while read -r name rest; do
    # shellcheck disable=SC2086
    run "$1" "$2" "$3" "$name" $rest
  done < <("$4")
}

echo condition,run,truth >"$out/runs.csv"
cp rawlogs/demo.rawlog rawlogs/demo.truth.csv "$out/logs/"
for scene in "${scenes[@]}"; do
  [[ -f $out/logs/$scene.rawlog ]] ||
    "$bin/perception-simulate" -c "ini/scenarios/$scene.ini" --vehicle ini/vehicles/kitti.ini --set scenario.duration=15 -o "$out/logs/$scene.rawlog" >/dev/null
done
for log in $([[ -n $held ]] || echo demo) "${scenes[@]}"; do series "$log" ini/demo.ini C+L lidar_settings; done
if [[ -d $data/kitti_lidar_seq0000 ]]; then
  k=$data/kitti_tracking
  [[ -f $out/logs/k0000.rawlog ]] || "$bin/perception-import" kitti --calib "$k/calib/0000.txt" --poses "$k/velo_poses/0000.txt" \
    --lidar "$data/kitti_lidar_seq0000/velodyne_front120" --labels "$k/label_02/0000.txt" --last 99 --rate 9.66 \
    --detections "rrc:Car=$k/det_rrc/Car/0000.txt" --detections "rrc:Pedestrian=$k/det_rrc/Pedestrian/0000.txt" \
    -o "$out/logs/k0000.rawlog" >/dev/null
  for sensors in $([[ -n $held ]] || echo L C+L); do series k0000 ini/kitti.ini "$sensors" lidar_settings; done
  for n in "${sequences[@]}"; do
    detections=()
    for class in Car Pedestrian Cyclist; do detections+=(--detections "pointrcnn:$class=$k/det_pointrcnn/$class/$n.txt"); done
    for class in Car Pedestrian; do detections+=(--detections "rrc:$class=$k/det_rrc/$class/$n.txt"); done
    [[ -f $out/logs/k$n.rawlog ]] || "$bin/perception-import" kitti --calib "$k/calib/$n.txt" --poses "$k/velo_poses/$n.txt" \
      --labels "$k/label_02/$n.txt" "${detections[@]}" -o "$out/logs/k$n.rawlog" >/dev/null
    for sensors in "${sets[@]}"; do series "k$n" ini/kitti-detections.ini "$sensors" box_settings; done
  done
fi
"$bin/perception-evaluate" --without-truth --manifest "$out/runs.csv" --range 40 --fov-deg 80 --complete-fov-deg 80 \
  --any-truth -o "$out/report"
