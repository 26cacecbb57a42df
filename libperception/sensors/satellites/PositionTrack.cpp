#include "libperception/sensors/satellites/PositionTrack.h"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

std::vector<std::string> fieldsOf(const std::string& text, char separator) {
  std::vector<std::string> out(1);
  for (const char c : text) {
    if (c == separator) {
      out.emplace_back();
    } else {
      out.back() += c;
    }
  }
  return out;
}

/// Parses the whole text as a number, independent of the locale.
std::optional<double> numberOf(const std::string& text) {
  double value = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return {};
  return value;
}

/// Degrees from ddmm.mmmm and a hemisphere.
std::optional<double> nmeaAngle(const std::string& text, const std::string& hemisphere) {
  const auto value = numberOf(text);
  if (!value || hemisphere.size() != 1) return {};
  const double degrees = std::floor(*value / 100), angle = degrees + (*value - 100 * degrees) / 60;
  switch (hemisphere[0]) {
    case 'N':
    case 'E':
      return angle;
    case 'S':
    case 'W':
      return -angle;
    default:
      return {};
  }
}

bool checksumHolds(const std::string& line, std::size_t star) {
  unsigned sum = 0;
  for (std::size_t i = 1; i < star; ++i) sum ^= static_cast<unsigned char>(line[i]);
  return std::strtoul(line.c_str() + star + 1, nullptr, 16) == sum;
}

/// A GGA sentence with a fix, or nothing.
std::optional<PositionTrack::Fix> fixOfGga(const std::string& line) {
  const std::size_t star = line.find('*');
  if (star != std::string::npos && !checksumHolds(line, star)) return {};
  const auto f = fieldsOf(line.substr(0, star), ',');
  if (f.size() < 7 || f[6].empty() || f[6] == "0") return {};
  const auto time = numberOf(f[1]);
  const auto latitude = nmeaAngle(f[2], f[3]), longitude = nmeaAngle(f[4], f[5]);
  if (!time || !latitude || !longitude) return {};
  const double hours = std::floor(*time / 1e4), minutes = std::floor(*time / 100) - 100 * hours;
  const double seconds = *time - 1e4 * hours - 100 * minutes;
  return PositionTrack::Fix{3600 * hours + 60 * minutes + seconds, *latitude, *longitude};
}

void add(const PositionTrack::Fix& fix, PositionTrack& track) {
  if (!track.fixes.empty() && fix.t <= track.fixes.back().t) {
    ++track.dropped;
  } else {
    track.fixes.push_back(fix);
  }
}

PositionTrack readNmea(const std::string& path) {
  PositionTrack track;
  std::ifstream file(path);
  double midnight = 0;  // [s] added after each
  std::size_t sentences = 0;
  for (std::string line; std::getline(file, line);) {
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
    if (line.size() < 6 || line[0] != '$') continue;
    ++sentences;
    if (line.substr(3, 3) != "GGA") continue;
    auto fix = fixOfGga(line);
    if (!fix) {
      ++track.dropped;
      continue;
    }
    constexpr double kDay = 86400;
    if (!track.fixes.empty() && fix->t + midnight < track.fixes.back().t - kDay / 2)
      midnight += kDay;
    fix->t += midnight;
    add(*fix, track);
  }
  if (file.bad()) throw DataError(path + ": reading failed", ExitCode::kIoError);
  if (sentences == 0) throw DataError(path + ": no NMEA sentence ($...): expected $--GGA lines");
  return track;
}

/// Seconds since 1970 from 2008-11-07T09:23:41Z, optionally with a fraction.
std::optional<double> timeOf(const char* text) {
  if (!text) return {};
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, used = 0;
  if (std::sscanf(text, "%4d-%2d-%2dT%2d:%2d:%n", &year, &month, &day, &hour, &minute, &used) != 5)
    return {};
  std::string seconds(text + used);
  while (!seconds.empty() && (seconds.back() == 'Z' || seconds.back() == ' ')) seconds.pop_back();
  const auto s = numberOf(seconds);
  if (!s) return {};
  // Days since 1970-01-01 in the proleptic Gregorian calendar (Howard Hinnant's algorithm).
  const int y = year - (month <= 2), era = y / 400, of_era = y - 400 * era;
  const int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
  const int days = era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
  return 86400.0 * days + 3600.0 * hour + 60.0 * minute + *s;
}

PositionTrack readGpx(const std::string& path) {
  tinyxml2::XMLDocument document;
  if (document.LoadFile(path.c_str()) != tinyxml2::XML_SUCCESS)
    throw DataError(
        fmt::format("{}:{}: not XML: {}", path, document.ErrorLineNum(), document.ErrorName()));
  const auto* gpx = document.FirstChildElement("gpx");
  if (!gpx) throw DataError(path + ": no <gpx> element: expected a GPX 1.1 file");
  PositionTrack track;
  for (auto* t = gpx->FirstChildElement("trk"); t; t = t->NextSiblingElement("trk")) {
    for (auto* s = t->FirstChildElement("trkseg"); s; s = s->NextSiblingElement("trkseg")) {
      for (auto* p = s->FirstChildElement("trkpt"); p; p = p->NextSiblingElement("trkpt")) {
        const char *lat = p->Attribute("lat"), *lon = p->Attribute("lon");
        const auto* time = p->FirstChildElement("time");
        const auto latitude = numberOf(lat ? lat : ""), longitude = numberOf(lon ? lon : "");
        const auto stamp = timeOf(time ? time->GetText() : nullptr);
        if (!latitude || !longitude)
          throw DataError(
              fmt::format("{}:{}: <trkpt>: expected numbers lat and lon", path, p->GetLineNum()));
        if (!stamp)
          throw DataError(fmt::format("{}:{}: <trkpt>: expected <time>2008-11-07T09:23:41Z</time>",
                                      path, p->GetLineNum()));
        add({*stamp, *latitude, *longitude}, track);
      }
    }
  }
  return track;
}

PositionTrack readCsv(const std::string& path) {
  const CsvTable table = CsvTable::fromFile(path);
  const auto t = table.column("t_s"), lat = table.column("lat_deg"), lon = table.column("lon_deg");
  PositionTrack track;
  for (std::size_t i = 0; i < table.rows(); ++i)
    add({table.real(i, t), table.real(i, lat), table.real(i, lon)}, track);
  return track;
}

}  // namespace

std::vector<Vector2> PositionTrack::local() const {
  std::vector<Vector2> out;
  if (fixes.empty()) return out;
  // Radii of curvature of the WGS 84 ellipsoid at the first fix.
  constexpr double kRadius = 6378137.0, kE2 = 6.69437999014e-3;
  const double latitude = radians(fixes.front().latitude), s = std::sin(latitude);
  const double w = std::sqrt(1 - kE2 * s * s);
  const double north = kRadius * (1 - kE2) / (w * w * w), east = kRadius / w * std::cos(latitude);
  for (const Fix& f : fixes) {
    const double longitude = wrapAngle(radians(f.longitude - fixes.front().longitude));
    out.emplace_back(east * longitude, north * radians(f.latitude - fixes.front().latitude));
  }
  return out;
}

PositionTrack readPositionTrack(const std::string& path) {
  if (!std::ifstream(path)) throw DataError(path + ": cannot be read", ExitCode::kNoInput);
  const std::string ending = std::filesystem::path(path).extension().string();
  PositionTrack track;
  if (ending == ".gpx") {
    track = readGpx(path);
  } else if (ending == ".csv") {
    track = readCsv(path);
  } else if (ending == ".nmea" || ending == ".txt" || ending == ".log") {
    track = readNmea(path);
  } else {
    throw DataError(path + ": ending '" + ending + "': expected .nmea, .txt, .log, .gpx or .csv");
  }
  track.name = std::filesystem::path(path).stem().string();
  return track;
}

}  // namespace perception
