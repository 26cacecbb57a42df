#!/usr/bin/env bash
# Everything from a bare Debian 12 on: packages, build, a first result, all tests.
#   ./setup.sh build   installs what is needed and builds the programs into build/bin
#   ./setup.sh demo    the same, then tracks, evaluates and draws the simulated log rawlogs/demo.rawlog
#   ./setup.sh package builds the Debian packages: build-package/*.deb
#   ./setup.sh bench   builds the benchmarks against other libraries and runs them one after the other
#   ./setup.sh fuzz [MINUTES]   feeds every parser with a fuzzer's bytes, 10 minutes together
#   ./setup.sh faults  every program with each of its calls failing, killed and stopped 200 times; half an hour
#   ./setup.sh soak [HOURS]    memory of a log of 10 hours
#   ./setup.sh sanitize   all tests with sanitizers, an hour
#   ./setup.sh test    the same with the tests, and runs them: all of them, and some once more with sanitizers;
#                      before them clang-format on all sources and clang-tidy on a few
# Run it as root or with password-less sudo. Running it again installs nothing new. JOBS=N sets the number of compilers at once.
set -euo pipefail
cd "$(dirname "$(readlink -f "$0")")"

readonly usage="usage: ./setup.sh build | demo | package | bench | test | sanitize | faults | soak [HOURS] | fuzz [MINUTES]"
readonly exit_usage=64 exit_unavailable=69  # libperception/core/Error.h

packages=(
  # to build
  g++ cmake
  ninja-build            # keeps all cores busy where Make waits for the library before
  mold                   # links 40 programs in a tenth of the time
  libmrpt-obs-dev        # observations, rawlogs
  libmrpt-maps-dev       # point clouds, occupancy grids
  libmrpt-bayes-dev      # the particle-filter framework
  libmrpt-random-dev     # its resampling draws from MRPT's generator
  libmrpt-io-dev         # (compressed) files
  libmrpt-opengl-dev     # pictures without a display
  libmrpt-img-dev        # images of observations
  libmrpt-config-dev     # the options of MRPT's particle filter
  libmrpt-hwdrivers-dev  # drivers for MRPT's recorder
  libmrpt-system-dev     # time stamps, file names
  libmrpt-topography-dev # latitudes and longitudes as east and north
  libeigen3-dev          # linear algebra
  libfmt-dev             # numbers as text, whatever the locale
  nlohmann-json3-dev     # events, run records, reports
  libcli11-dev           # command lines
  librandom123-dev       # random numbers by counter
  libtbb-dev             # threads
  libnlopt-dev           # noise parameters by maximum likelihood
  libboost-dev           # quantiles of beta and gamma distributions; HTTP and WebSocket (Beast)
  libtinyxml2-dev        # GPX files
  liblzf-dev             # compressed PCD files
  libminizip-dev         # archives of numpy (.npz)
  zlib1g-dev             # rawlogs are gzip files; check sums
  libisal-dev            # inflates rawlogs, twice as fast as zlib
  libzstd-dev            # rawlogs of newer MRPT; MCAP
  liblz4-dev libbz2-dev  # MCAP, ROS bags
  libssl-dev             # SHA-256 of inputs
  libsqlite3-dev         # database of a batch, recordings of ROS 2
  liboctomap-dev         # safety grid
  libembree-dev          # ray casting of the simulator
  libopencv-core-dev libopencv-imgproc-dev libopencv-imgcodecs-dev  # labels on pictures, PNG
  libopencv-dnn-dev libopencv-objdetect-dev  # detectors: networks, people
  libopencv-ml-dev libopencv-video-dev libopencv-calib3d-dev  # random forests of a study, motion of cameras from their images
  libmatio-dev           # part models as MATLAB files
  cyclonedds-dev cyclonedds-tools  # observations and scenes between computers
  pybind11-dev python3-dev  # the module perception of Python
  # to run
  libgl1-mesa-dri        # draws without a graphics card
  gnuplot-nox            # plots of the evaluation
  ffmpeg                 # videos
)
test_packages=(
  libgtest-dev           # tests
  mrpt-apps              # rawlog-edit, rawlog-grabber: stock MRPT must read and record our logs
  python3-numpy          # the module perception, the reader of runs in apps/perception-export
  python3-scipy          # the second implementation of AMOTA and AMOTP: tests/bench/kitti/tracking_benchmark.py
  mypy                   # type hints of the module
  python3-nbclient python3-ipykernel python3-matplotlib  # the notebook and the pictures of examples/python
  chromium               # pages of a run and of a batch are opened, clicked and read
  locales                # definition of a locale with decimal comma: it must not change a byte
)

# On Debian 12 alone: other versions format differently, and other releases lack the second DDS, which plays a vehicle with ROS 2.
style_packages=()
! grep -q '^VERSION_ID="12"' /etc/os-release 2>/dev/null || { style_packages=(clang-format-14 clang-tidy-14); test_packages+=(libfastrtps-dev); }

package_packages=(
  dpkg-dev file          # dependencies of what is packed
  help2man               # manual pages
)

fuzz_packages=(
  clang-14 libclang-rt-14-dev  # libFuzzer
)

bench_packages=(
  python3-numpy python3-scipy  # scores and errors of tracking on KITTI: tests/bench/kitti
  libpcl-dev             # ground by RANSAC, clusters by a tree of points: peers of the lidar front end
  libnanoflann-dev       # the same by region growing; kd-tree of snow filters, peers of the trust in returns
  libopencv-contrib-dev  # cv::dpm, peer of the part models
)

say() { printf '\n== %s\n' "$*"; }

# Says how long a step takes, measured on two cores with a fast network, before it starts.
announce() { printf '\n== %s (about %s on two cores)\n' "$1" "$2"; }

die() { printf 'setup.sh: error: %s\n' "$2" >&2; exit "$1"; }

# Memory decides, too: MRPT's and Eigen's templates take up to 2 GB a compiler.
jobs() {
  local cores memory_gb
  cores=$(nproc)
  memory_gb=$(awk '/^MemTotal/ {print int($2 / 2^20 + 0.5)}' /proc/meminfo)
  local by_memory=$(( memory_gb / 2 > 1 ? memory_gb / 2 : 1 ))
  echo "${JOBS:-$(( cores < by_memory ? cores : by_memory ))}"
}

installPackages() {
  local missing=() name
  for name in "$@"; do
    [[ $(dpkg-query -W -f='${db:Status-Status}' "$name" 2>/dev/null) == installed ]] || missing+=("$name")
  done
  (( ${#missing[@]} )) || return 0
  announce "Installing ${#missing[@]} Debian packages with what they need: ${missing[*]}" "3 minutes"
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3)
  if (( EUID != 0 )); then
    sudo -n true 2>/dev/null ||
      die $exit_unavailable "packages are missing and sudo would ask. As root: apt-get install --no-install-recommends ${missing[*]}"
    apt=(sudo -n "${apt[@]}")
  fi
  "${apt[@]}" update
  "${apt[@]}" install --no-install-recommends "${missing[@]}"
}

# configure [cmake arguments]: quiet unless it fails. A folder that was configured with Make before stays with Make.
configure() {
  if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  CMAKE_GENERATOR=Ninja cmake "$@" >"$scratch" 2>&1 || { cat "$scratch" >&2; die 1 "CMake could not configure the build: cmake $*"; }
}

# compile FOLDER [cmake --build arguments]: says how far it is in place of a line a source
compile() {
  local folder=$1 began=$SECONDS
  shift
  cmake --build "$folder" -j "$(jobs)" "$@" 2>&1 | showProgress || die 1 "the build failed: cmake --build $folder $*"
  printf '  built in %s\n' "$(minutes $(( SECONDS - began )))"
}

minutes() { printf '%d:%02d minutes' $(( $1 / 60 )) $(( $1 % 60 )); }

# Lines of Make ("[ 12%] ...") and of Ninja ("[3/25] ...") become one line that changes, in a file one line every ten percent. What
# compilers and the linker have to say stays as it is.
showProgress() {
  local line share next=0 began=$SECONDS end=$'\n'
  [[ ! -t 1 ]] || end=$'\033[K\r'
  while IFS= read -r line; do
    if [[ $line =~ ^\[\ *([0-9]+)%\] ]]; then
      share=${BASH_REMATCH[1]}
    elif [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]]; then
      share=$(( 100 * BASH_REMATCH[1] / BASH_REMATCH[2] ))
    else
      [[ $line =~ ^(Consolidate\ compiler|Scanning\ dep|(g?make(\[[0-9]+\])?|ninja):\ (Entering|Leaving)) ]] || printf '%s\n' "$line"
      continue
    fi
    if [[ $end != $'\n' ]] || (( share >= next )); then
      printf '  %3d %% built, %s%s' "$share" "$(minutes $(( SECONDS - began )))" "$end"
      next=$(( share / 10 * 10 + 10 ))
    fi
  done
  [[ $end == $'\n' ]] || printf '\033[K'
}

# build PRESET TESTS(ON|OFF) TIME [cmake --build arguments]: TIME as announced
build() {
  local preset=$1 tests=$2 folder=build
  [[ $preset == release ]] || folder=build-$preset
  announce "Building in $folder, $(jobs) compilers at once" "$3"
  shift 3
  configure --preset "$preset" -DPERCEPTION_TESTS="$tests"
  compile "$folder" "$@"
}

demo() {
  installPackages "${packages[@]}"
  build release OFF "7 minutes" --target perception-track perception-evaluate perception-snapshot perception-report
  announce "Tracking, evaluating and drawing the simulated log" "1 minute"
  PERCEPTION_DATA=. PATH=$PWD/build/bin:$PATH apps/perception-demo/perception-demo out/demo
}

# Programs, library and headers as Debian packages, and what `apt install` of them does: README.
package() {
  installPackages "${packages[@]}" "${package_packages[@]}"
  announce "Building the packages" "8 minutes"
  configure --preset release -B build-package -DPERCEPTION_TESTS=OFF -DPERCEPTION_MANUALS=ON -DCMAKE_INSTALL_PREFIX=/usr
  compile build-package
  (cd build-package && cpack -G DEB)
}

# Every program of tests/bench; quiet machines give steadier figures.
benches() {
  installPackages "${packages[@]}" "${bench_packages[@]}"
  announce "Building the benchmarks" "10 minutes"
  configure --preset release -B build-bench -DPERCEPTION_TESTS=OFF -DPERCEPTION_BENCH=ON
  compile build-bench
  local program
  for program in build-bench/bin/*_bench; do
    printf '\n$ %s\n' "$program"
    "$program"
  done
}

# A locale with decimal comma for the tests, in the build folder and not in the system.
makeCommaLocale() {
  export LOCPATH=$PWD/build/locale
  export LSAN_OPTIONS="suppressions='$PWD/tests/leaks.supp':print_suppressions=0"
  export TSAN_OPTIONS="suppressions='$PWD/tests/races.supp':print_suppressions=0"
  mkdir -p "$LOCPATH"
  [[ -d $LOCPATH/de_DE.UTF-8 ]] || localedef -i de_DE -f UTF-8 "$LOCPATH/de_DE.UTF-8" || true
}

# runTests PRESET [ctest arguments]: remembers the closing lines, failed and skipped tests; false when a test failed
runTests() {
  local preset=$1 folder=$2 code=0
  shift 2
  announce "Testing ($preset)" "$( [[ $preset == release ]] && echo "6 minutes" || echo "1 minute" )"
  ctest --preset "$preset" -j "$(jobs)" "$@" | tee "$scratch" || code=$?
  closing+="$preset: $(grep -E 'tests? (passed|failed)' "$scratch" || true)"$'\n'
  closing+="$(grep -E '^Total Test time' "$scratch" || true)"$'\n'
  # A log of CI may show only its end.
  failures+=$(grep -haE '^\[  FAILED  \] [^ ]+(, | \()|^\s+[0-9]+ - .*\(' "$scratch" | sed "s/^ */  $preset: /" || true)$'\n'
  # GoogleTest says "file:line: Skipped" and the reason in the next line.
  skipped+=$(grep -hA1 ': Skipped$' "$folder/Testing/Temporary/LastTest.log" | grep -v '^--$' |
    sed "s|^$PWD/||" | paste -d ' ' - - | sed "s/^/  /" || true)$'\n'
  # Everything that a test starts is in test_packages: on a machine of a developer it would be there by accident.
  if grep -q 'missing tool: ' "$folder/Testing/Temporary/LastTest.log"; then
    closing+="$preset: FAILED, tests were skipped for a tool that setup.sh does not install: $(
      grep -oh 'missing tool: .*' "$folder/Testing/Temporary/LastTest.log" | sed 's/missing tool: //' | sort -u | paste -sd ',')"$'\n'
    code=1
  fi
  return "$code"
}

# sources FOLDERS...: our sources and headers below them
sources() { find "$@" -name '*.cpp' -o -name '*.h' | LC_ALL=C sort; }

checkFormat() {
  say "Checking the format"
  sources libperception gui-offscreen studies apps tests | xargs -n 40 -P "$(jobs)" clang-format-14 --dry-run -Werror
}

# checked NAME CHECK: the closing lines say how it went
checked() {
  local code=0
  (( ${#style_packages[@]} )) || { closing+="$1: not checked, its program is Debian 12's"$'\n'; return 0; }
  "$2" || code=$?
  closing+="$1: $( ((code == 0)) && echo passed || echo FAILED )"$'\n'
  return "$code"
}

# Modules that are clean and cheap: 1 to 6 s a source, three CPU-minutes in all. Tests stay out, and so
# do loops that shuffle g++'s vectors. It gets compile commands of its own, one a source.
checkHabits() {
  say "Checking with clang-tidy"
  configure --preset release -B build-tidy -DPERCEPTION_TESTS=OFF -DPERCEPTION_UNITY=OFF
  sources libperception/{core,config,simd,radar,boxes3d} | grep -E '[.]cpp$' |
    xargs -n 1 -P "$(jobs)" clang-tidy-14 --quiet -p build-tidy --extra-arg=-Wno-unknown-warning-option 2>&1 |
    { grep -vE '^[0-9]+ warnings? generated' || true; }
}

tests() {
  installPackages "${packages[@]}" "${test_packages[@]}" "${style_packages[@]}"
  makeCommaLocale
  closing="" skipped="" failures=""
  local failed=0
  checked format checkFormat || failed=1
  build release ON "16 minutes"
  checked clang-tidy checkHabits || failed=1
  runTests release build || failed=1
  sanitized asan core config sensors || failed=1
  closingLines
  return "$failed"
}

# sanitized PRESET MODULE...: builds the tests of these modules with sanitizers and runs them
sanitized() {
  local preset=$1 modules=("${@:2}")
  build "$preset" ON "$(( 3 * ${#modules[@]} )) minutes" --target "${modules[@]/%/_tests}"
  runTests "$preset" "build-$preset" -R "^($(IFS='|'; echo "${modules[*]}"))\$"
}

closingLines() {
  say "Skipped tests and why"
  printf '%s' "$skipped" | sort -u | sed '/^ *$/d'
  [[ -z ${failures//$'\n'} ]] || { say "Failed tests"; printf '%s' "$failures" | LC_ALL=C sort -u | sed '/^ *$/d'; }
  say "Closing lines"
  printf '%s' "$closing"
}

# Longer than a change should wait for: all modules with AddressSanitizer and UBSan, those with threads with ThreadSanitizer;
# not faults, which has a malloc() of its own.
sanitize() {
  installPackages "${packages[@]}" "${test_packages[@]}"
  makeCommaLocale
  closing="" skipped="" failures=""
  local failed=0 modules
  mapfile -t modules < <(cd tests && find . -mindepth 2 \( -name '*_test.cpp' -o -name '*_test.py' \) | cut -d/ -f2 | LC_ALL=C sort -u |
    grep -vxE 'architecture|faults|studies')
  sanitized asan "${modules[@]}" || failed=1
  sanitized tsan filter pipeline || failed=1
  closingLines
  return "$failed"
}

# Parsers one after the other, from the corpus in build-fuzz/corpus (kept) and the seeds of the tree. A finding stays as
# build-fuzz/NAME-crash-...; FUZZ_TARGET=NAME build-fuzz/bin/perception_fuzz FILE runs it again.
fuzz() {
  local minutes=$1 name names seconds failed=0
  installPackages "${packages[@]}" "${fuzz_packages[@]}"
  announce "Building with clang" "10 minutes"
  configure -B build-fuzz -DCMAKE_CXX_COMPILER=clang++-14 -DCMAKE_BUILD_TYPE=RelWithDebInfo \
    -DCMAKE_CXX_FLAGS_RELWITHDEBINFO="-O1 -g1 -DNDEBUG" -DPERCEPTION_WERROR=OFF \
    -DPERCEPTION_TESTS=OFF -DPERCEPTION_FUZZ=ON -DPERCEPTION_SANITIZE=fuzzer-no-link,address,undefined
  compile build-fuzz --target perception_fuzz
  mapfile -t names < <(build-fuzz/bin/perception_fuzz 2>/dev/null </dev/null)
  (( ${#names[@]} )) || die 70 "build-fuzz/bin/perception_fuzz names no target"
  seconds=$(( minutes * 60 / ${#names[@]} + 1 ))
  for name in "${names[@]}"; do
    local seeds=()
    mkdir -p "build-fuzz/corpus/$name"
    [[ ! -d tests/fuzz/seeds/$name ]] || seeds=("tests/fuzz/seeds/$name")
    local code=0
    FUZZ_TARGET=$name ASAN_OPTIONS=detect_leaks=0:allocator_may_return_null=1 UBSAN_OPTIONS=halt_on_error=1 \
      build-fuzz/bin/perception_fuzz -max_total_time="$seconds" -timeout=2 -rss_limit_mb=1024 -max_len=40000 \
      -print_final_stats=1 -artifact_prefix="build-fuzz/$name-" "build-fuzz/corpus/$name" "${seeds[@]}" \
      >"$scratch" 2>&1 || code=$?
    printf '%-18s %s inputs, code %s\n' "$name" "$(sed -n 's/stat::number_of_executed_units: //p' "$scratch")" "$code"
    (( code == 0 )) || { failed=1; tail -n 30 "$scratch"; }
  done
  return "$failed"
}

# Every call of every program fails once; 200 are killed, 200 stopped.
faults() {
  installPackages "${packages[@]}" "${test_packages[@]}"
  build release ON "6 minutes" --target faults_tests
  PERCEPTION_FAULTS=all build/bin/faults_tests
}

# Eight radars that repeat an encounter: the cheapest log with objects that come and go.
soak() {
  installPackages "${packages[@]}" "${test_packages[@]}"
  build release ON "4 minutes" --target perception_soak
  build/bin/perception_soak rawlogs/radar.rawlog ini/skynet.ini "$1" run.sensors=R
}

[[ $# == 1 || ( $# == 2 && ( $1 == fuzz || $1 == soak ) && $2 =~ ^[1-9][0-9]*$ ) ]] || { echo "$usage" >&2; exit $exit_usage; }
scratch=$(mktemp)
readonly scratch
trap 'rm -f "$scratch"' EXIT
case $1 in
  build) installPackages "${packages[@]}"; build release OFF "11 minutes" ;;
  demo) demo ;;
  package) package ;;
  bench) benches ;;
  test) tests ;;
  sanitize) sanitize ;;
  faults) faults ;;
  soak) soak "${2:-10}" ;;
  fuzz) fuzz "${2:-10}" ;;
  *) echo "$usage" >&2; exit $exit_usage ;;
esac
