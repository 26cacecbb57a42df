// Every parser of files of others on bytes that a fuzzer makes (libFuzzer, with sanitizers). One
// program: FUZZ_TARGET=NAME perception_fuzz [libFuzzer's options] [CORPUS]. A parser may refuse
// with an Error of ours and nothing else. Run by ./setup.sh fuzz MINUTES. Rawlogs are not among
// them: MRPT's classes allocate what a length in the file says, which sanitizers cannot limit;
// tests/sensors/RawlogReader_test.cpp changes their bytes within a limit of memory.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>
#include <string_view>

#include "libperception/config/Config.h"
#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/core/LaneMap.h"
#include "libperception/importers/AimotiveFiles.h"
#include "libperception/importers/CloudTable.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/KittiFiles.h"
#include "libperception/importers/RadiateFiles.h"
#include "libperception/importers/VodFiles.h"
#include "libperception/interop/ReadingBag.h"
#include "libperception/measurement/ObjectClass.h"
#include "libperception/packets/Beams.h"
#include "libperception/packets/CanBundle.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/Ibeo.h"
#include "libperception/packets/Ouster.h"
#include "libperception/packets/Pcap.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {
namespace {

/// A file in memory, by its path.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(::memfd_create("fuzz", 0)) {
    if (file_ < 0 ||
        ::write(file_, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      std::abort();
  }
  ~MemoryFile() { ::close(file_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

/// Calls a reader of files with the path of the bytes.
template <class Reader>
std::function<void(std::string_view)> ofFile(Reader reader) {
  return [reader](std::string_view bytes) { reader(MemoryFile(bytes).path()); };
}

void readBag(const std::string& path) {
  const auto bag = openBag(path);
  for (BagMessage message; bag->next(message);) {
  }
}

/// The first byte chooses the device.
void decodePackets(std::string_view bytes) {
  if (bytes.empty()) return;
  const auto& kinds = deviceKinds();
  const auto& kind = kinds[static_cast<unsigned char>(bytes[0]) % kinds.size()];
  if (kind.needs_file) return;
  const auto decoder = kind.make("");
  SequenceCounter counter;
  for (int again = 0; again < 2; ++again) counter.count(decoder->decode(bytes.substr(1)));
}

/// In two parts; the first byte says where. Each message is decoded.
void cutIbeo(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t first =
      std::min<std::size_t>(static_cast<unsigned char>(bytes[0]), bytes.size());
  IbeoStream stream;
  const auto decoder = deviceKind("ibeo").make("");
  for (const std::string_view part : {bytes.substr(0, first), bytes.substr(first)}) {
    for (const std::string& message : stream.add(part)) {
      try {
        decoder->decode(message);
      } catch (const DataError&) {  // the next one is decoded all the same
      }
    }
  }
}

void readClasses(std::string_view bytes) {
  Config config = Config::fromText(std::string(bytes), "fuzz.ini");
  readClassTable(config);
  config.finish();
}

struct Target {
  const char* name;
  std::function<void(std::string_view)> run;
};

const Target kTargets[] = {
    {"ini", &readClasses},
    {"csv", [](std::string_view b) { CsvTable::fromText(std::string(b)); }},
    {"truth", ofFile([](const std::string& p) { readGroundTruth(p); })},
    {"lanes", ofFile([](const std::string& p) { LaneMap::fromFile(p); })},
    {"bag", ofFile(&readBag)},
    {"packets", &decodePackets},
    {"candump", [](std::string_view b) { parseCandump(b); }},
    {"can_bundle", [](std::string_view b) { parseCanBundle(b); }},
    {"ibeo_stream", &cutIbeo},
    {"pcap", [](std::string_view b) { parsePcap(b, "fuzz.pcap"); }},
    {"ouster", [](std::string_view b) { parseOusterMetadata(std::string(b), "fuzz.json"); }},
    {"beams", ofFile([](const std::string& p) { readBeams(p, 40); })},
    {"kitti_calibration", ofFile([](const std::string& p) { readKittiCalibration(p); })},
    {"kitti_labels", ofFile([](const std::string& p) { readKittiLabels(p); })},
    {"kitti_boxes", ofFile([](const std::string& p) { readKittiDetections(p, "boxes3d", "Car"); })},
    {"kitti_oxts", ofFile([](const std::string& p) { readKittiOxts(p); })},
    {"poses", ofFile([](const std::string& p) { readKittiPoses(p, "kitti"); })},
    {"tum", ofFile([](const std::string& p) { readTumPoses(p); })},
    {"pcd", [](std::string_view b) { readPcd("fuzz.pcd", std::string(b)); }},
    {"ply", [](std::string_view b) { readPly("fuzz.ply", std::string(b)); }},
    {"vod_radar", ofFile([](const std::string& p) { readVodRadar(p); })},
    {"vod_pose", ofFile([](const std::string& p) { readVodPose(p); })},
    {"radiate", ofFile([](const std::string& p) { readRadiateAnnotations(p); })},
    {"radiate_times", ofFile([](const std::string& p) { readRadiateTimes(p); })},
    {"aimotive_boxes", ofFile([](const std::string& p) { readAimotiveBoxes(p); })},
    {"aimotive_radar", ofFile([](const std::string& p) { readAimotiveRadar(p); })},
};

/// Without one the names of all, and the end.
const Target* chosen() {
  const char* name = std::getenv("FUZZ_TARGET");
  for (const Target& target : kTargets) {
    if (name == nullptr) std::printf("%s\n", target.name);
    if (name != nullptr && std::string_view(name) == target.name) return &target;
  }
  std::exit(name == nullptr ? 0 : 64);
}

const Target* target = nullptr;

}  // namespace
}  // namespace perception

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  perception::target = perception::chosen();
  perception::registerPerceptionClasses();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  try {
    perception::target->run({reinterpret_cast<const char*>(data), size});
  } catch (const perception::Error&) {  // refused, as it should be
  }
  return 0;
}
