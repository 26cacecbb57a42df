#include "libperception/packets/Decoder.h"

#include "libperception/core/Error.h"
#include "libperception/packets/Decoders.h"

namespace perception {
namespace {

using File = const std::string&;

}  // namespace

const std::vector<DeviceKind>& deviceKinds() {
  static const std::vector<DeviceKind> kinds = {
      {"velodyne", "Velodyne VLP-16, VLP-32C", true, 2368, false, 200,
       [](File) { return makeVelodyneDecoder(); }},
      {"pandar40p", "Hesai Pandar40P; file: beams of the unit", true, 2368, false, 200,
       &makePandar40pDecoder},
      {"xt32", "Hesai XT32; file: beams of the unit", true, 2368, false, 120, &makeXt32Decoder},
      {"ouster", "Ouster OS-0, OS-1, OS-2; file: the sensor's metadata", true, 7502, true, 120,
       &makeOusterDecoder},
      {"ars548", "Continental ARS548: detections", false, 42102, false, 300,
       [](File) { return makeArs548Decoder(); }},
      {"srr520", "Continental SRR520: detections, by CAN FD", false, 0, false, 100,
       [](File) { return makeSrr520Decoder(); }},
  };
  return kinds;
}

const DeviceKind& deviceKind(const std::string& name) {
  std::string known;
  for (const DeviceKind& kind : deviceKinds()) {
    if (name == kind.name) return kind;
    known += std::string(" ") + kind.name;
  }
  throw ConfigError("device '" + name + "' is not known; there are" + known);
}

}  // namespace perception
