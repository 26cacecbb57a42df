#include "libperception/packets/Decoder.h"

#include "libperception/core/Error.h"
#include "libperception/packets/Decoders.h"
#include "libperception/packets/Encoder.h"

namespace perception {
namespace {

using File = const std::string&;

}  // namespace

const std::vector<DeviceKind>& deviceKinds() {
  constexpr auto kUdp = Transport::kUdp;
  static const std::vector<DeviceKind> kinds = {
      {"velodyne", "Velodyne HDL-32E, VLP-16, VLP-32C", true, kUdp, 2368, false, 200,
       [](File) { return makeVelodyneDecoder(); }, &makeVelodyneEncoder},
      {"pandar40p", "Hesai Pandar40P; file: beams of the unit", true, kUdp, 2368, false, 200,
       &makePandar40pDecoder, &makePandar40pEncoder},
      {"xt32", "Hesai XT32; file: beams of the unit", true, kUdp, 2368, false, 120,
       &makeXt32Decoder, &makeXt32Encoder},
      {"ouster", "Ouster OS-0, OS-1, OS-2; file: the sensor's metadata", true, kUdp, 7502, true,
       120, &makeOusterDecoder, &makeOusterEncoder},
      {"ibeo", "Ibeo LUX, ALASCA XT, ECU: scans", true, Transport::kTcp, 12002, false, 200,
       [](File) { return makeIbeoDecoder(); }, &makeIbeoEncoder},
      {"ars548", "Continental ARS548: detections", false, kUdp, 42102, false, 300,
       [](File) { return makeArs548Decoder(); }, &makeArs548Encoder},
      {"srr520", "Continental SRR520: detections, by CAN FD", false, Transport::kCan, 0, false, 100,
       [](File) { return makeSrr520Decoder(); }, &makeSrr520Encoder},
      {"esr", "Delphi ESR: tracks with a measurement, by CAN", false, Transport::kCan, 0, false,
       175, [](File) { return makeEsrDecoder(); }, &makeEsrEncoder},
      {"ars408", "Continental ARS 408: clusters or objects, by CAN", false, Transport::kCan, 0,
       false, 250, [](File) { return makeArs408Decoder(); }, &makeArs408Encoder},
      {"rs16", "RoboSense RS-LiDAR-16; file: beams of the unit, or a DIFOP packet", true, kUdp,
       6699, false, 150, &makeRs16Decoder, &makeRs16Encoder, 7788},
      {"rs32", "RoboSense RS-LiDAR-32; file: beams of the unit, or a DIFOP packet", true, kUdp,
       6699, false, 200, &makeRs32Decoder, &makeRs32Encoder, 7788},
      {"helios16", "RoboSense Helios-16P; file: beams of the unit, or a DIFOP packet", true, kUdp,
       6699, false, 150, &makeHelios16Decoder, &makeHelios16Encoder, 7788},
      {"helios32", "RoboSense Helios of 32 beams; file: as helios16", true, kUdp, 6699, false, 150,
       &makeHelios32Decoder, &makeHelios32Encoder, 7788},
      {"bpearl", "RoboSense Bpearl; file: beams of the unit, or a DIFOP packet", true, kUdp, 6699,
       false, 30, &makeBpearlDecoder, &makeBpearlEncoder, 7788},
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
