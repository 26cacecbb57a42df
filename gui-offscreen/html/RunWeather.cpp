#include "gui-offscreen/html/RunWeather.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iterator>
#include <map>

#include "libperception/core/Csv.h"
#include "libperception/core/CsvStream.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kTypes[] = {"clear", "rain", "snow", "fog"};

double roundedTo(double value, double steps) { return std::round(value * steps) / steps; }

/// Rows of a table by sensor, `most` of each, evenly spread: each is given to `row`.
void eachThinned(const std::string& path, std::size_t most,
                 const std::function<void(const std::string&, const CsvTable&)>& row) {
  std::map<std::string, std::size_t> counts;
  for (CsvStream rows(path); rows.next();)
    ++counts[std::string(rows.row().text(0, rows.row().column("sensor")))];
  struct Place {
    std::size_t row = 0, kept = 0;
  };
  std::map<std::string, Place> places;
  for (CsvStream rows(path); rows.next();) {
    const std::string label(rows.row().text(0, rows.row().column("sensor")));
    const std::size_t count = counts[label];
    Place& place = places[label];
    const std::size_t wanted = count <= most ? place.row : place.kept * count / most;
    if (place.row++ != wanted || (count > most && place.kept >= most)) continue;
    ++place.kept;
    row(label, rows.row());
  }
}

/// Appends a value of the row, to 1/steps; null where it is empty.
void put(Json& values, const CsvTable& row, const std::string& name, double steps = 100) {
  const double value = row.realOrNan(0, row.column(name));
  values.push_back(std::isfinite(value) ? Json(roundedTo(value, steps)) : Json(nullptr));
}

void putWeather(Json& entry, const CsvTable& row) {
  put(entry["t"], row, "t", 1000);
  for (std::size_t i = 0; i < std::size(kTypes); ++i)
    put(entry["p"][i], row, std::string("p_") + kTypes[i], 1000);
  constexpr const char* kParts[] = {"", "_low", "_high"};
  for (const char* name : {"rain", "snow", "visibility"}) {
    for (std::size_t i = 0; i < std::size(kParts); ++i)
      put(entry[name][i], row, std::string(name) + kParts[i]);
  }
  const double returns = row.real(0, row.column("returns"));
  const double doubted = row.real(0, row.column("doubted"));
  entry["doubted"].push_back(roundedTo(doubted / std::max(returns, 1.0), 1e5));
}

}  // namespace

Json weatherOf(const std::string& dir, std::size_t most) {
  Json list = Json::array();
  if (!fs::exists(dir + "/weather.csv")) return list;
  std::map<std::string, Json> sensors;
  eachThinned(dir + "/weather.csv", most, [&](const std::string& sensor, const CsvTable& row) {
    putWeather(sensors[sensor], row);
  });
  if (fs::exists(dir + "/ledger.csv")) {
    eachThinned(dir + "/ledger.csv", most, [&](const std::string& sensor, const CsvTable& row) {
      const auto known = sensors.find(sensor);
      if (known == sensors.end()) return;
      Json& ledger = known->second["ledger"];
      put(ledger["t"], row, "t", 1000);
      put(ledger["clusters"], row, "clusters", 1);
      put(ledger["phantoms"], row, "phantom_clusters", 1);
    });
  }
  for (auto& [sensor, entry] : sensors) {
    entry["sensor"] = sensor;
    list.push_back(std::move(entry));
  }
  return list;
}

}  // namespace perception
