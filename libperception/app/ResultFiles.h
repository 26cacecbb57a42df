#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace perception {

/// All bytes of a file. Throws DataError.
std::string contentsOf(const std::filesystem::path& path);

/// A JSON file. Throws DataError.
nlohmann::json jsonOf(const std::filesystem::path& path);

/// The lines of a JSON lines file as an array. Throws DataError with the line.
nlohmann::json linesOf(const std::filesystem::path& path);

}  // namespace perception
