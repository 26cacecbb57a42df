#!/usr/bin/env bash
# Tracking of detectors' boxes on KITTI's tracking sequences, all classes at once: imports the sequences (once), tracks them
# with ini/kitti-detections.ini and scores the result by CLEAR MOT, sAMOTA and HOTA (3D overlap of .25): at the threshold of
# the best MOTA, as is the custom, and of all that is output at one score, as a vehicle would use it. Leaves OUT/report.md,
# OUT/res (KITTI's format) and OUT/run. Half a minute for `dev` on four cores.
#   tests/bench/kitti/kitti_detections.sh [-t SCORE] [-m 2d] [-c INI] [-d DETECTOR] [-o OUT] [dev | train | SEQUENCE ...] [perception-track options]
#   -m   2d: image boxes at an overlap of .5, for cameras alone (--sensors C --set run.output_sensor=rrc) [3d]
#   -d   boxes of cars of virconv, casa, pvcnn, second_iou or pointrcnn in data/kitti_tracking_detectors, as sensor boxes3d (ini/any-detector.ini)
#   -t   the one score, log-odds that it exists and is a road user [0]
# PERCEPTION_SHARED: folder with data/kitti_tracking and tools/mot_eval.py [../shared]; PERCEPTION_BIN: programs [build/bin].
# Needs python3-numpy and python3-scipy. What decides is `dev`; the configuration was counted on `train`.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../../.."

threshold=0 mode=3d detector= ini=ini/kitti-detections.ini out=out/kitti_detections
while getopts t:m:c:d:o: option; do
  case $option in
    t) threshold=$OPTARG ;;
    m) mode=$OPTARG ;;
    c) ini=$OPTARG ;;
    d) detector=$OPTARG ;;
    o) out=$OPTARG ;;
    *) exit 64 ;;
  esac
done
shift $((OPTIND - 1))
sequences=()
while [[ ${1:-} =~ ^[0-9]+$ ]]; do sequences+=("$(printf '%04d' "$((10#$1))")"); shift; done
case ${1:-} in
  dev) shift; sequences=(0001 0006 0010 0012 0013 0014 0019) ;;
  train) shift; sequences=(0000 0002 0003 0004 0005 0007 0009 0011 0017 0020) ;;
esac
(( ${#sequences[@]} )) || sequences=(0001 0006 0010 0012 0013 0014 0019)

readonly bin=${PERCEPTION_BIN:-build/bin} shared=${PERCEPTION_SHARED:-../shared}
readonly data=$shared/data/kitti_tracking logs=${out%/}/logs
for needed in "$data/label_02" "$data/det_pointrcnn" "$shared/tools/mot_eval.py"; do
  [[ -e $needed ]] || { echo "skipped: $needed is not there (PERCEPTION_SHARED)"; exit 0; }
done
readonly detectors=${data}_detectors
export bin data logs ini out detector detectors
mkdir -p "$logs" "$out/res"
if [[ -n $detector ]]; then  # the same configuration, of a sensor of that name
  sed "s/pointrcnn/boxes3d/g; s|^include = \([^/]\)|include = $PWD/ini/\1|" "$ini" >"$out/detector.ini"
  ini=$out/detector.ini
fi
rm -f "$out"/res/*.txt "$out"/*.log

import() {
  local n=$1 detections=() class
  [[ -f $logs/$n.rawlog ]] && return
  if [[ -n $detector ]]; then
    gunzip -c "$detectors/$detector/$n.txt.gz" >"$logs/$n.$detector.txt"
    detections=(--detections "boxes3d:Car=$logs/$n.$detector.txt")
  else
    for class in Car Pedestrian Cyclist; do detections+=(--detections "pointrcnn:$class=$data/det_pointrcnn/$class/$n.txt"); done
  fi
  for class in Car Pedestrian; do detections+=(--detections "rrc:$class=$data/det_rrc/$class/$n.txt"); done
  "$bin/perception-import" kitti --calib "$data/calib/$n.txt" --poses "$data/velo_poses/$n.txt" \
    --labels "$data/label_02/$n.txt" "${detections[@]}" -o "$logs/$n.rawlog" >"$out/import_$n.log" 2>&1 ||
    { cat "$out/import_$n.log" >&2; return 1; }
}

track() {
  local n=$1 code=0
  shift
  "$bin/perception-track" -c "$ini" -i "$logs/$n.rawlog" -o "$out/run/$n" --overwrite --threads 1 \
    --export "kitti:$out/res/$n.txt" "$@" >"$out/track_$n.log" 2>&1 || code=$?
  (( code == 0 || code == 3 )) || { cat "$out/track_$n.log" >&2; return 1; }  # 3: done, with warnings
}
export -f import track

# The longest first: the others end meanwhile.
printf '%s\n' "${sequences[@]}" | sort -r |
  xargs -P "$(nproc)" -I{} bash -c 'import "$0" && track "$0" "$@"' {} "$@"

/usr/bin/python3 tests/bench/kitti/kitti_detections.py --tools "$shared/tools" --data "$data" --out "$out" \
  --threshold "$threshold" --mode "$mode" --config "$ini" --options "$*" "${sequences[@]}"
