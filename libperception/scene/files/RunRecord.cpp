#include "libperception/scene/files/RunRecord.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"
#include "libperception/scene/files/NumberFormat.h"
#include "libperception/scene/files/OutputFile.h"

namespace perception {
namespace {

using Json = nlohmann::ordered_json;

/// A log that may be cut between two entries.
constexpr char kNotVerifiable[] = "not verifiable";

std::string fileName(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

Json sensorJson(const SensorRecord& s) {
  return {{"label", s.label},
          {"modality", s.modality},
          {"frames", s.frames},
          {"measurements", s.measurements},
          {"dropped_points", s.dropped_points},
          {"dropped_measurements", s.dropped_measurements},
          {"dropped_frames", s.dropped_frames}};
}

SensorRecord sensorFrom(const Json& j) {
  SensorRecord s;
  j.at("label").get_to(s.label);
  j.at("modality").get_to(s.modality);
  j.at("frames").get_to(s.frames);
  j.at("measurements").get_to(s.measurements);
  j.at("dropped_points").get_to(s.dropped_points);
  j.at("dropped_measurements").get_to(s.dropped_measurements);
  j.at("dropped_frames").get_to(s.dropped_frames);
  return s;
}

Stamp stampFrom(const Json& j, const std::string& path) {
  Stamp stamp;
  const auto text = j.get<std::string>();
  if (!parseDecimalSeconds(text, stamp.ns)) {
    throw DataError(
        fmt::format("{}: found '{}', expected seconds such as 1700000000.000000000", path, text));
  }
  return stamp;
}

RunRecord recordFrom(const Json& j, const std::string& path) {
  RunRecord r;
  j.at("program").get_to(r.program);
  j.at("version").get_to(r.version);
  r.hash = j.value("hash", "");
  const Json& input = j.at("input");
  input.at("name").get_to(r.input);
  input.at("bytes").get_to(r.input_bytes);
  input.at("entries").get_to(r.input_entries);
  input.at("end").get_to(r.input_end);
  input.at("end_detail").get_to(r.input_end_detail);
  r.input_verifiable = input.value("whole", "") != kNotVerifiable;
  r.first_stamp = stampFrom(input.at("first_stamp"), path);
  r.last_stamp = stampFrom(input.at("last_stamp"), path);
  j.at("simulated").get_to(r.simulated);
  if (j.contains("weather")) r.weather = j.at("weather").get<std::string>();
  j.at("config").get_to(r.config);
  j.at("seed").get_to(r.seed);
  j.at("sensors_used").get_to(r.sensors_used);
  j.at("association").get_to(r.association);
  j.at("particles").get_to(r.particles);
  j.at("scenes").get_to(r.scenes);
  j.at("tracks").get_to(r.tracks);
  for (const Json& s : j.at("sensors")) r.sensors.push_back(sensorFrom(s));
  for (const auto& [kind, count] : j.at("events").items())
    r.events[kind] = count.get<std::uint64_t>();
  j.at("warnings").get_to(r.warnings);
  return r;
}

}  // namespace

std::string toJson(const RunRecord& r) {
  Json j;
  j["program"] = r.program;
  j["version"] = r.version;
  j["hash"] = r.hash;
  j["input"] = {{"name", fileName(r.input)},
                {"bytes", r.input_bytes},
                {"entries", r.input_entries},
                {"end", r.input_end},
                {"end_detail", r.input_end_detail},
                {"whole", r.input_end != "clean" ? "no"
                          : r.input_verifiable   ? "verified"
                                                 : kNotVerifiable},
                {"first_stamp", decimalSeconds(r.first_stamp.ns)},
                {"last_stamp", decimalSeconds(r.last_stamp.ns)}};
  j["simulated"] = r.simulated;
  if (r.weather) j["weather"] = *r.weather;
  j["config"] = fileName(r.config);
  j["seed"] = r.seed;
  j["sensors_used"] = r.sensors_used;
  j["association"] = r.association;
  j["particles"] = r.particles;
  j["scenes"] = r.scenes;
  j["tracks"] = r.tracks;
  j["sensors"] = Json::array();
  for (const SensorRecord& s : r.sensors) j["sensors"].push_back(sensorJson(s));
  j["events"] = Json::object();
  for (const auto& [kind, count] : r.events) j["events"][kind] = count;
  j["warnings"] = r.warnings;
  return j.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

void writeRunRecord(const std::string& path, const RunRecord& record) {
  writeFile(path, toJson(record));
}

RunRecord readRunRecord(const std::string& path) {
  if (const auto what = irregularity(path); !what.empty())
    throw DataError(fmt::format("{}: is {}, expected a file", path, what));
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw DataError(fmt::format("{}: no such file, or it cannot be read", path),
                    ExitCode::kNoInput);
  try {
    return recordFrom(Json::parse(in), path);
  } catch (const Json::exception& e) {
    throw DataError(fmt::format("{}: not a record of a run: {}", path, e.what()));
  }
}

}  // namespace perception
