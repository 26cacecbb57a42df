#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace perception {

/// The weather of a run's folder as its page shows it: for each lidar of weather.csv and
/// ledger.csv the columns over time: t [s], p (probability by type), rain, snow [mm/h] and
/// visibility [m] as value, low, high, share of returns doubted, phantom clusters a scan. At most
/// `most` scans of a lidar, evenly spread. An empty list without weather.csv. Throws DataError.
nlohmann::json weatherOf(const std::string& dir, std::size_t most = 1500);

}  // namespace perception
