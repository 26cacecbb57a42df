#!/bin/bash
# perception-grabber killed (-9) at random instants, and on a full disk:
#   tests/bench/speed/capture_kills.sh BIN FOLDER [TIMES, 50]
# Every closed chunk must be whole: MRPT's rawlog-edit reads as many objects as capture.jsonl says. At most one chunk,
# the open one, may be lost. A small tmpfs (needs root) is then filled: exit 74, closed chunks whole.
set -u
bin=$1 folder=$2 times=${3:-50}
plugin=$("$bin/perception-grabber" --plugin) || exit 1
mkdir -p "$folder"
sed -e 's/^chunk_seconds.*/chunk_seconds = 0.4/' -e 's/^free_mb.*/free_mb = 0/' -e 's/^start_delay.*/start_delay = 0.2/' \
    ini/capture_stock.ini > "$folder/capture.ini"
grep -q '^chunk_seconds' "$folder/capture.ini" || sed -i 's/^\[global\]/[global]\nchunk_seconds = 0.4\nfree_mb = 0/' "$folder/capture.ini"
chunks=0 faults=0 open_chunks=0 objects=0
# Chunks of a capture: whole, listed, without a hole. Counts into the three figures.
check() {
  local n=0 parts
  for chunk in "$1"/capture_*.rawlog; do
    [ -e "$chunk" ] || continue
    n=$((n + 1))
    # rawlog-edit ends with 0 for a torn file, too: the objects that it found must be those that were written.
    local read written
    gzip -t < "$chunk" 2> /dev/null || { echo "$chunk: torn"; faults=$((faults + 1)); }
    read=$(rawlog-edit -p "$plugin" -i "$chunk" --info 2> /dev/null | sed -n 's/^Overall number of objects *: //p')
    written=$(sed -n "s/.*\"$(basename "$chunk")\",\"entries\":\([0-9]*\).*/\1/p" "$1/capture.jsonl" 2> /dev/null)
    # The note of a chunk that was renamed a moment before may be missing.
    if [ -n "$written" ] || [ "$chunk" != "$(ls "$1"/capture_*.rawlog | tail -n 1)" ]; then
      [ "$read" = "$written" ] || { echo "$chunk: $read objects read, $written written"; faults=$((faults + 1)); }
      objects=$((objects + ${read:-0}))
    fi
  done
  [ -e "$1/$(printf 'capture_%04d.rawlog' "$n")" ] || [ "$n" = 0 ] || { echo "$1: a chunk is missing"; faults=$((faults + 1)); }
  parts=$(find "$1" -type f ! -name 'capture_*.rawlog' ! -name capture.jsonl | wc -l)
  [ "$parts" -le 1 ] || { echo "$1: $parts open chunks"; faults=$((faults + 1)); }
  chunks=$((chunks + n)) open_chunks=$((open_chunks + parts))
}
for i in $(seq "$times"); do
  rm -rf "$folder/out"
  "$bin/perception-grabber" -c "$folder/capture.ini" -o "$folder/out" > "$folder/said.txt" 2>&1 &
  pid=$!
  sleep "$((1 + RANDOM % 4)).$((RANDOM % 10))$((RANDOM % 10))"
  for child in $(pgrep -P "$pid"); do kill -9 "$child"; done
  kill -9 "$pid" 2> /dev/null
  wait "$pid" 2> /dev/null
  [ -d "$folder/out" ] && check "$folder/out"
done
echo "killed $times times: $chunks closed chunks whole ($objects objects read by rawlog-edit), $open_chunks open ones lost, $faults faults"
disk=$folder/disk
mkdir -p "$disk"
if mount -t tmpfs -o size=2m tmpfs "$disk" 2> /dev/null; then
  "$bin/perception-grabber" -c "$folder/capture.ini" -o "$disk/out" --duration 60 > "$folder/said.txt" 2>&1
  code=$?
  chunks=0
  check "$disk/out"
  echo "full disk: exit $code (74 expected), $chunks closed chunks whole; said: $(tail -n 1 "$folder/said.txt")"
  [ "$code" = 74 ] && [ "$chunks" -gt 0 ] || faults=$((faults + 1))
  umount "$disk"
else
  echo "full disk: not tried, no tmpfs can be mounted"
fi
[ "$faults" = 0 ]
