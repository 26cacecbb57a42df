#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/lidars/RoboSense.h"

namespace perception {
namespace {

using namespace std::string_view_literals;

// Of DIFOP packets.
constexpr auto kDifop = "\xA5\xFF\x00\x5A\x11\x11\x55\x55"sv;
constexpr std::size_t kPitchesOf16 = 1165, kElevationsOf32 = 468, kAzimuthsOf32 = 564;
constexpr double kFromNominal = 2;  ///< [deg] (assumed) most of a unit's angle

/// Three bytes a laser [0.0001 deg]; the first eight look down.
std::vector<BeamAngles> pitchesOf16(std::string_view payload) {
  std::vector<BeamAngles> beams;
  for (std::size_t i = 0; i < kRs16.lasers; ++i) {
    const double angle = 1e-4 * static_cast<double>(bigEndian(payload, kPitchesOf16 + 3 * i, 3));
    beams.push_back({i < kRs16.lasers / 2 ? -angle : angle, 0});
    if (std::abs(beams[i].elevation - rs16Beams()[i].elevation) > kFromNominal) return {};
  }
  return beams;
}

/// A sign and two bytes a laser [0.001 or 0.01 deg, by the firmware]; empty: not set.
std::vector<double> anglesIn(std::string_view payload, std::size_t from, std::size_t lasers,
                             double unit) {
  std::vector<double> angles;
  for (std::size_t at = from; angles.size() < lasers; at += 3) {
    const auto sign = bigEndian(payload, at, 1);
    if (sign > 1) return {};
    const double angle = unit * static_cast<double>(bigEndian(payload, at + 1, 2));
    angles.push_back(sign == 1 ? -angle : angle);
  }
  return angles;
}

bool areDifferent(std::vector<double> angles) {
  std::sort(angles.begin(), angles.end());
  return !angles.empty() && std::adjacent_find(angles.begin(), angles.end()) == angles.end();
}

/// How far the lasers look down and up tells the unit of the angles, too, where it is known.
bool fit(const std::vector<double>& elevations, const RoboSenseModel& model) {
  const auto [low, high] = std::minmax_element(elevations.begin(), elevations.end());
  if (model.exactly)
    return std::abs(*low - model.lowest) <= kFromNominal &&
           std::abs(*high - model.highest) <= kFromNominal;
  return *low >= model.lowest && *high <= model.highest && areDifferent(elevations);
}

std::vector<BeamAngles> beamsIn(std::string_view payload, const RoboSenseModel& model) {
  // A Helios of 32 beams has angles behind those of one of 16.
  if (&model == &kHelios16 && areDifferent(anglesIn(payload, kElevationsOf32, 32, 0.01))) return {};
  for (const double unit : {0.001, 0.01}) {
    if (!model.exactly && unit < 0.01) continue;
    const auto elevations = anglesIn(payload, kElevationsOf32, model.lasers, unit);
    const auto azimuths = anglesIn(payload, kAzimuthsOf32, model.lasers, unit);
    if (elevations.empty() || azimuths.empty()) return {};
    if (!fit(elevations, model)) continue;
    std::vector<BeamAngles> beams;
    for (std::size_t i = 0; i < model.lasers; ++i) beams.push_back({elevations[i], azimuths[i]});
    return beams;
  }
  return {};
}

}  // namespace

bool isDifop(std::string_view payload) {
  return payload.size() == kRoboSenseSize && payload.substr(0, kDifop.size()) == kDifop;
}

const std::vector<BeamAngles>& rs16Beams() {
  static const std::vector<BeamAngles> beams = [] {
    std::vector<BeamAngles> list;
    for (int i = 0; i < 8; ++i) list.push_back({2.0 * i - 15, 0});
    for (int i = 0; i < 8; ++i) list.push_back({15 - 2.0 * i, 0});
    return list;
  }();
  return beams;
}

std::vector<BeamAngles> beamsOfDifop(std::string_view payload, const RoboSenseModel& model) {
  if (!isDifop(payload)) return {};
  return model.id == kRs16.id ? pitchesOf16(payload) : beamsIn(payload, model);
}

std::vector<BeamAngles> robosenseBeams(const std::string& file, const RoboSenseModel& model) {
  if (file.empty()) return model.id == kRs16.id ? rs16Beams() : std::vector<BeamAngles>();
  std::ifstream in(file, std::ios::binary);
  std::string bytes(kRoboSenseSize + 1, '\0');
  in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
  if (!isDifop(bytes)) return readBeams(file, model.lasers);
  auto beams = beamsOfDifop(bytes, model);
  if (beams.empty())
    throw DataError(file + ": a DIFOP packet without angles of an " + std::string(model.name));
  return beams;
}

}  // namespace perception
