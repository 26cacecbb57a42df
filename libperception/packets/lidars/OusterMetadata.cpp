#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "libperception/core/Error.h"
#include "libperception/packets/lidars/Ouster.h"

namespace perception {
namespace {

using nlohmann::json;

/// The object's member, or that of the older, flat layout; empty where neither is.
const json* member(const json& all, const char* group, const char* key) {
  if (all.contains(group) && all[group].is_object() && all[group].contains(key))
    return &all[group][key];
  return all.contains(key) ? &all[key] : nullptr;
}

class MetadataReader {
 public:
  MetadataReader(const json& all, std::string name) : all_(all), name_(std::move(name)) {}

  OusterMetadata read() {
    OusterMetadata m;
    m.altitudes = angles("beam_altitude_angles");
    m.azimuths = angles("beam_azimuth_angles");
    if (m.altitudes.size() != m.azimuths.size())
      refuse("beam_azimuth_angles: " + std::to_string(m.azimuths.size()) + " angles, expected " +
             std::to_string(m.altitudes.size()));
    if (std::all_of(m.altitudes.begin(), m.altitudes.end(), [](double a) { return a == 0; }))
      refuse("beam_altitude_angles: all are 0");
    if (m.altitudes.size() != natural("pixels_per_column", 128))
      refuse("beam_altitude_angles: " + std::to_string(m.altitudes.size()) + " angles for " +
             std::to_string(natural("pixels_per_column", 128)) + " pixels_per_column");
    m.columns_per_frame = natural("columns_per_frame", 4096);
    m.columns_per_packet = natural("columns_per_packet", 64);
    if (m.columns_per_frame % m.columns_per_packet != 0)
      refuse("columns_per_frame: no multiple of columns_per_packet");
    if (const json* profile = member(all_, format(), "udp_profile_lidar")) {
      if (!profile->is_string()) refuse("udp_profile_lidar: no text");
      m.profile = profile->get<std::string>();
    }
    const json* origin = member(all_, "beam_intrinsics", "lidar_origin_to_beam_origin_mm");
    m.origin_to_beam = 0.001 * (origin && origin->is_number() ? origin->get<double>() : 15.806);
    return m;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw DataError(name_ + ": " + what); }
  const char* format() const {
    return all_.contains("lidar_data_format") ? "lidar_data_format" : "data_format";
  }

  std::vector<double> angles(const char* key) const {
    const json* value = member(all_, "beam_intrinsics", key);
    if (!value || !value->is_array() || value->empty()) refuse(std::string(key) + ": missing");
    std::vector<double> list;
    for (const json& angle : *value) {
      if (!angle.is_number()) refuse(std::string(key) + ": holds what is no number");
      list.push_back(angle.get<double>());
    }
    return list;
  }

  std::size_t natural(const char* key, std::size_t most) const {
    const json* value = member(all_, format(), key);
    if (!value || !value->is_number_integer()) refuse(std::string(key) + ": missing");
    const auto number = value->get<std::int64_t>();
    if (number < 1 || number > static_cast<std::int64_t>(most))
      refuse(std::string(key) + ": " + std::to_string(number) + ", expected 1 to " +
             std::to_string(most));
    return static_cast<std::size_t>(number);
  }

  const json& all_;
  std::string name_;
};

}  // namespace

OusterMetadata parseOusterMetadata(const std::string& text, const std::string& name) {
  const json all = json::parse(text, nullptr, false);
  if (!all.is_object()) throw DataError(name + ": no metadata of an Ouster sensor (JSON expected)");
  return MetadataReader(all, name).read();
}

OusterMetadata readOusterMetadata(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw DataError(path + ": cannot be read", ExitCode::kNoInput);
  const std::string text((std::istreambuf_iterator<char>(file)), {});
  return parseOusterMetadata(text, path);
}

}  // namespace perception
