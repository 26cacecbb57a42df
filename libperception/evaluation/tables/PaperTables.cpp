#include "libperception/evaluation/tables/PaperTables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "libperception/core/Error.h"

namespace perception {

// Values as printed in [radecki2016], not computed or rounded.

const std::vector<PaperTrackingRow>& paperTrackingRows() {
  static const std::vector<PaperTrackingRow> rows = {
      // results_lidar, results_camera, results_full: all encounters, by weather
      {"wet", "Cloudy & Wet", "L+R", .988, .700, .063, .726, .000, 1493},
      {"wet", "Cloudy & Wet", "C+R", .916, 1.414, .083, .971, .000, 552},
      {"wet", "Cloudy & Wet", "C+L+R", .985, .825, .056, .876, .000, 1517},
      {"sunny", "Sunny", "L+R", .999, 1.437, .083, .664, .000, 1480},
      {"sunny", "Sunny", "C+R", .867, 1.657, .121, .971, .002, 588},
      {"sunny", "Sunny", "C+L+R", .998, 1.544, .077, .875, .000, 1455},
      {"night", "Night", "L+R", .987, 1.424, .060, .872, .000, 1781},
      {"night", "Night", "C+R", .620, 1.425, .112, .590, .000, 432},
      {"night", "Night", "C+L+R", .989, 1.320, .070, .889, .000, 1779},
      {"snow", "Snow & Rain", "L+R", .986, 1.484, .085, .601, .052, 1783},
      {"snow", "Snow & Rain", "C+R", .739, 1.627, .127, .951, .000, 450},
      {"snow", "Snow & Rain", "C+L+R", .995, 1.499, .085, .744, .040, 1807},
      // results_person, results_suburban: all weather
      {"pedestrian", "Pedestrian", "C+L+R", .995, 1.230, .081, .864, .018, 3964},
      {"pedestrian", "Pedestrian", "C+R", .638, 1.482, .169, .962, .003, 373},
      {"pedestrian", "Pedestrian", "L+R", .995, 1.252, .084, .852, .024, 3972},
      {"vehicle", "Vehicle", "C+L+R", .986, 1.477, .058, .811, .000, 2594},
      {"vehicle", "Vehicle", "C/H+R", .655, 1.578, .110, .818, .000, 1369},
      {"vehicle", "Vehicle", "C+R", .818, 1.531, .102, .875, .000, 1776},
      {"vehicle", "Vehicle", "L+R", .982, 1.410, .053, .509, .000, 2565},
      // results_particles: sunny, C+L+R
      {"particles", "1 particle", "C+L+R", .993, 1.698, .068, .917, .001, 1484},
      {"particles", "4 particles", "C+L+R", .998, 1.545, .076, .870, .000, 1496},
      {"particles", "8 particles", "C+L+R", .998, 1.544, .077, .875, .000, 1455},
  };
  return rows;
}

const std::vector<PaperFrontEndRow>& paperFrontEndRows() {
  static const std::vector<PaperFrontEndRow> rows = {
      {"Lidar", "Sunny", .91, .79, .51, .88, .89, .55},
      {"Camera", "Sunny", .85, {}, .95, .70, {}, .90},
      {"Camera", "Rainy", {}, {}, .93, {}, {}, .76},
  };
  return rows;
}

const std::vector<PaperParticlesRow>& paperParticlesRows() {
  static const std::vector<PaperParticlesRow> rows = {
      {1, 2.76, 4.39, 1.94},  {4, 2.45, 4.10, 1.80},  {8, 2.32, 3.80, 1.80},
      {12, 2.21, 3.57, 1.84}, {16, 2.33, 3.54, 1.64}, {20, 2.31, 3.18, 1.78},
  };
  return rows;
}

const std::vector<PaperRateRow>& paperRateRows() {
  static const std::vector<PaperRateRow> rows = {
      {"C-1k", false, 0.61, 0.46, 0.15},      {"C-2k", false, 1.98, 1.53, 0.45},
      {"C-4k", false, 10.50, 4.52, 5.98},     {"C-8k", false, 35.44, 8.12, 27.31},
      {"L", false, 12.04, 9.26, 2.78},        {"C-1k+R", true, 41.10, 3.00, 0.04},
      {"C-2k+R", true, 42.86, 7.31, 0.22},    {"C-4k+R", true, 50.02, 14.14, 2.49},
      {"C-8k+R", true, 63.16, 27.99, 4.35},   {"L+R", true, 63.11, 0.27, 3.20},
      {"C-8k+L+R", true, 81.86, 27.67, 9.44},
  };
  return rows;
}

namespace {

// A word of a weather's text with an amount ("snow 1 mm/h", not "snow cover .5") or alone.
bool says(const std::string& weather, const std::string& word) {
  std::size_t at = 0;
  while (at < weather.size()) {
    const std::size_t end = std::min(weather.find(", ", at), weather.size());
    const std::string part = weather.substr(at, end - at);
    if (part == word) return true;
    if (part.rfind(word + ' ', 0) == 0 && part.size() > word.size() + 1 &&
        std::isdigit(static_cast<unsigned char>(part[word.size() + 1])))
      return true;
    at = end + 2;
  }
  return false;
}

}  // namespace

bool paperTableHasWeather(const std::string& table, const std::string& weather) {
  if (table == "pedestrian" || table == "vehicle") return true;
  const bool snow = says(weather, "snow"), rain = says(weather, "rain"), fog = says(weather, "fog");
  if (table == "snow") return snow;
  if (snow || rain || fog) return false;
  const bool night = says(weather, "night"), wet = says(weather, "water film");
  if (table == "night") return night;
  if (table == "wet") return wet && !night;
  return !night && !wet && !says(weather, "cloudy");
}

bool paperConditionHasWeather(const std::string& condition, const std::string& weather) {
  if (condition == "Rainy") return says(weather, "rain") && !says(weather, "snow");
  return paperTableHasWeather("sunny", weather);
}

std::vector<std::string> paperTableNames() {
  std::vector<std::string> names;
  for (const PaperTrackingRow& row : paperTrackingRows()) {
    if (std::find(names.begin(), names.end(), row.table) == names.end())
      names.emplace_back(row.table);
  }
  return names;
}

std::vector<PaperTrackingRow> paperRowsOf(const std::vector<std::string>& tables) {
  const std::vector<std::string> known = paperTableNames();
  std::vector<PaperTrackingRow> rows;
  for (const std::string& table : tables) {
    if (std::find(known.begin(), known.end(), table) == known.end()) {
      throw Error(ExitCode::kUsage,
                  fmt::format("--paper {}: there are: {}", table, fmt::join(known, ", ")));
    }
    for (const PaperTrackingRow& row : paperTrackingRows()) {
      if (row.table == table) rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace perception
