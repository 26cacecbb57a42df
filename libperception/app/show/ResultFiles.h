#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace perception {

/// All bytes of a file. Throws DataError.
std::string contentsOf(const std::filesystem::path& path);

/// A JSON file. Throws DataError.
nlohmann::json jsonOf(const std::filesystem::path& path);

/// The lines of a JSON lines file as an array. Throws DataError with the line.
nlohmann::json linesOf(const std::filesystem::path& path);

/// Whether a product says that it is of all these runs; false where it does not say of which run
/// it is. Throws DataError where it is of another one.
bool isOfRuns(const std::filesystem::path& path, const std::vector<std::string>& ids);

/// A run's figures in the report.json of an evaluation; null where the file does not say of which
/// run it is. Throws DataError where it is of other runs.
nlohmann::json figuresOf(const std::filesystem::path& report, const std::string& id);

}  // namespace perception
