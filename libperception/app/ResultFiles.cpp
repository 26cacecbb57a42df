#include "libperception/app/ResultFiles.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <sstream>

#include "libperception/core/Error.h"

namespace perception {

namespace fs = std::filesystem;

std::string contentsOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes((std::istreambuf_iterator<char>(file)), {});
  if (!file && !file.eof()) throw DataError(path.string() + ": cannot be read");
  return bytes;
}

nlohmann::json jsonOf(const fs::path& path) {
  try {
    return nlohmann::json::parse(contentsOf(path));
  } catch (const nlohmann::json::exception& error) {
    throw DataError(path.string() + ": no JSON: " + error.what());
  }
}

nlohmann::json linesOf(const fs::path& path) {
  nlohmann::json all = nlohmann::json::array();
  std::istringstream lines(contentsOf(path));
  for (std::string line; std::getline(lines, line);) {
    try {
      all.push_back(nlohmann::json::parse(line));
    } catch (const nlohmann::json::exception& error) {
      throw DataError(
          fmt::format("{}: line {}: no JSON: {}", path.string(), all.size() + 1, error.what()));
    }
  }
  return all;
}

}  // namespace perception
