#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "libperception/core/Error.h"
#include "libperception/importers/Importer.h"
#include "libperception/packets/FrameAssembler.h"
#include "libperception/packets/Pcap.h"

namespace perception {
namespace {

/// The packets of one device in a capture file.
class PacketsImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    std::string kinds;
    for (const DeviceKind& kind : deviceKinds()) {
      if (kind.transport != Transport::kUdp) continue;
      names_.emplace_back(kind.name);
      kinds += fmt::format("{}{}: {}", kinds.empty() ? "" : "; ", kind.name, kind.description);
    }
    cli.add_option("--pcap", pcap_, "capture of UDP packets, .pcap or .pcap.gz")->required();
    cli.add_option("--device", device_, kinds)->required()->check(CLI::IsMember(names_));
    cli.add_option("--device-file", file_, "beams or metadata of the unit, by kind");
    cli.add_option("--port", port_, "UDP port of the device; default: the kind's usual one")
        ->check(CLI::Range(1, 65535));
    cli.add_option("--sensor-pose", pose_,
                   "on the vehicle: x y z [m], yaw pitch roll [deg]; ego origin: on the ground, x "
                   "forward; default: 0 0 1.73 of a lidar, 3.5 0 0.5 of a radar")
        ->expected(6);
    cli.add_option("--label", label_, "sensor label; default: LIDAR_TOP or RADAR_FRONT");
  }

  void run(ImportLog& log) override {
    const DeviceKind& kind = deviceKind(device_);
    if (kind.needs_file && file_.empty()) failUsage("--device-file: needed by " + device_);
    const std::uint16_t port = port_ > 0 ? static_cast<std::uint16_t>(port_) : kind.port;
    const PcapContents contents = readPcap(pcap_);
    for (const std::string& warning : contents.warnings) log.warn(warning);
    std::int64_t frame = 0, others = 0;
    FrameAssembler assembler(kind, file_, labelOf(kind), mountOf(kind), [&](SensorFrame&& scan) {
      if (!log.wants(frame++)) return;
      log.frame(scan.stamp, frame - 1);
      log.sensor(scan);
    });
    std::int64_t done = 0;
    for (const UdpPacket& packet : contents.packets) {
      if (packet.port == port || (kind.second_port > 0 && packet.port == kind.second_port)) {
        assembler.add(packet.payload, Stamp{packet.stamp_ns});
      } else {
        ++others;
      }
      log.progress(++done, static_cast<std::int64_t>(contents.packets.size()));
    }
    assembler.finish();
    report(log, assembler, port, others);
  }

 private:
  std::string labelOf(const DeviceKind& kind) const {
    return !label_.empty() ? label_ : kind.lidar ? "LIDAR_TOP" : "RADAR_FRONT";
  }

  Pose3 mountOf(const DeviceKind& kind) const {
    std::vector<double> p = pose_;
    if (p.empty() && kind.lidar) p = {0, 0, 1.73, 0, 0, 0};
    if (p.empty()) p = {3.5, 0, 0.5, 0, 0, 0};
    return makePose(p[0], p[1], p[2], radians(p[3]), radians(p[4]), radians(p[5]));
  }

  void report(ImportLog& log, const FrameAssembler& assembler, std::uint16_t port,
              std::int64_t others) const {
    const PacketLedger& ledger = assembler.ledger();
    if (ledger.received == 0)
      throw DataError(fmt::format("{}: no packet to port {} among {}", pcap_, port, others));
    if (assembler.frames() == 0)
      throw DataError(fmt::format(
          "{}: none of {} packets is one of {}{}", pcap_, ledger.received, device_,
          assembler.warnings().empty() ? std::string() : "; " + assembler.warnings().front()));
    for (const std::string& warning : assembler.warnings()) log.warn(pcap_ + ": " + warning);
    if (ledger.lost > 0) {
      std::string ranges;
      for (const std::string& range : assembler.lostRanges()) ranges += " " + range;
      log.warn(
          fmt::format("{}: {} packets missing by their numbers:{}", pcap_, ledger.lost, ranges));
    }
    log.note(fmt::format("packets of {}: {} received, {} damaged, {} lost, {} repeated, {} late",
                         device_, ledger.received, ledger.damaged, ledger.lost, ledger.repeated,
                         ledger.late));
    if (others > 0) log.note(fmt::format("{} packets to other ports left out", others));
    log.note("no poses in a capture of one device: the vehicle is taken to stand still");
  }

  std::string pcap_, device_, file_, label_;
  std::vector<std::string> names_;
  std::vector<double> pose_;
  int port_ = 0;
};

}  // namespace

std::unique_ptr<Importer> makePacketsImporter() { return std::make_unique<PacketsImporter>(); }

}  // namespace perception
