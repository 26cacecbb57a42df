#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace perception {

/// All bytes of a file. Throws DataError.
std::string contentsOf(const std::filesystem::path& path);

/// A JSON file. Throws DataError.
nlohmann::json jsonOf(const std::filesystem::path& path);

/// Calls `each` with every line of a JSON lines file. Throws DataError with the line.
void eachLineOf(const std::filesystem::path& path,
                const std::function<void(const nlohmann::json&)>& each);

/// Whether a product says that it is of all these runs; false where it does not say of which run
/// it is. Throws DataError where it is of another one.
bool isOfRuns(const std::filesystem::path& path, const std::vector<std::string>& ids);

/// A run's figures in the report.json of an evaluation; null where the file does not say of which
/// run it is. Throws DataError where it is of other runs.
nlohmann::json figuresOf(const std::filesystem::path& report, const std::string& id);

}  // namespace perception
