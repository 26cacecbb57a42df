#include "gui-offscreen/html/RunWeather.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <vector>

#include "libperception/core/Csv.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kTypes[] = {"clear", "rain", "snow", "fog"};

double roundedTo(double value, double steps) { return std::round(value * steps) / steps; }

/// Rows of each sensor, `most` of them.
std::map<std::string, std::vector<std::size_t>> rowsBySensor(const CsvTable& table,
                                                             std::size_t most) {
  std::map<std::string, std::vector<std::size_t>> rows;
  const auto sensor = table.column("sensor");
  for (std::size_t i = 0; i < table.rows(); ++i)
    rows[std::string(table.text(i, sensor))].push_back(i);
  for (auto& [label, all] : rows) {
    if (all.size() <= most) continue;
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < most; ++i) kept.push_back(all[i * all.size() / most]);
    all = kept;
  }
  return rows;
}

/// A column, as numbers times `factor`; null where it is empty.
Json columnOf(const CsvTable& table, const std::vector<std::size_t>& rows, const std::string& name,
              double steps = 100) {
  Json values = Json::array();
  const auto column = table.column(name);
  for (const std::size_t i : rows) {
    const double value = table.realOrNan(i, column);
    values.push_back(std::isfinite(value) ? Json(roundedTo(value, steps)) : Json(nullptr));
  }
  return values;
}

Json intervalOf(const CsvTable& table, const std::vector<std::size_t>& rows,
                const std::string& name) {
  Json columns = Json::array();
  for (const char* part : {"", "_low", "_high"})
    columns.push_back(columnOf(table, rows, name + part));
  return columns;
}

}  // namespace

Json weatherOf(const std::string& dir, std::size_t most) {
  Json sensors = Json::array();
  if (!fs::exists(dir + "/weather.csv")) return sensors;
  const CsvTable table = CsvTable::fromFile(dir + "/weather.csv");
  for (const auto& [sensor, rows] : rowsBySensor(table, most)) {
    Json entry = {{"sensor", sensor}, {"t", columnOf(table, rows, "t", 1000)}};
    for (const char* type : kTypes)
      entry["p"].push_back(columnOf(table, rows, std::string("p_") + type, 1000));
    for (const char* name : {"rain", "snow", "visibility"})
      entry[name] = intervalOf(table, rows, name);
    for (const std::size_t i : rows) {
      const double returns = table.real(i, table.column("returns"));
      const double doubted = table.real(i, table.column("doubted"));
      entry["doubted"].push_back(roundedTo(doubted / std::max(returns, 1.0), 1e5));
    }
    sensors.push_back(std::move(entry));
  }
  if (!fs::exists(dir + "/ledger.csv")) return sensors;
  const CsvTable ledger = CsvTable::fromFile(dir + "/ledger.csv");
  for (const auto& [sensor, rows] : rowsBySensor(ledger, most)) {
    const auto known =
        std::find_if(sensors.begin(), sensors.end(),
                     [&label = sensor](const Json& s) { return s.at("sensor") == label; });
    if (known == sensors.end()) continue;
    (*known)["ledger"] = {{"t", columnOf(ledger, rows, "t", 1000)},
                          {"clusters", columnOf(ledger, rows, "clusters", 1)},
                          {"phantoms", columnOf(ledger, rows, "phantom_clusters", 1)}};
  }
  return sensors;
}

}  // namespace perception
