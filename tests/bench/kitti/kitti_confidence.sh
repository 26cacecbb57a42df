#!/usr/bin/env bash
# How true the learned confidence of five networks' boxes is on KITTI's tracking sequences: imports them (once) and leaves
# OUT/report with tables, reliability curve and convergence (perception-calibrate learnt).
#   tests/bench/kitti/kitti_confidence.sh [-o OUT] [dev | train]
# PERCEPTION_SHARED: folder with data/kitti_tracking and data/kitti_tracking_detectors [../shared]; PERCEPTION_BIN: programs [build/bin].
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")/../../.."

out=out/kitti_confidence
while getopts o: option; do
  case $option in
    o) out=$OPTARG ;;
    *) exit 64 ;;
  esac
done
shift $((OPTIND - 1))
sequences=(0001 0006 0010 0012 0013 0014 0019)
[[ ${1:-dev} == train ]] && sequences=(0000 0002 0003 0004 0005 0007 0009 0011 0017 0020)

readonly bin=${PERCEPTION_BIN:-build/bin} data=${PERCEPTION_SHARED:-../shared}/data/kitti_tracking
[[ -e ${data}_detectors ]] || { echo "skipped: ${data}_detectors is not there (PERCEPTION_SHARED)"; exit 0; }
logs=()
for detector in virconv casa pvcnn second_iou pointrcnn; do
  mkdir -p "$out/$detector"
  for n in "${sequences[@]}"; do
    log=$out/$detector/$n
    [[ -f ${data}_detectors/$detector/$n.txt.gz ]] || continue
    if [[ ! -f $log.rawlog ]]; then
      gunzip -c "${data}_detectors/$detector/$n.txt.gz" >"$log.boxes.txt"
      "$bin/perception-import" kitti --calib "$data/calib/$n.txt" --poses "$data/velo_poses/$n.txt" --labels "$data/label_02/$n.txt" \
        --detections "boxes3d:Car=$log.boxes.txt" -o "$log.rawlog" >"$log.import.log" 2>&1 || { cat "$log.import.log" >&2; exit 1; }
    fi
    logs+=("$log.rawlog")
  done
done
rm -rf "$out/report"
"$bin/perception-calibrate" learnt -c ini/any-detector.ini -i "${logs[@]}" -o "$out/report"
