#include "libperception/pictures/pages/ResultFiles.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iterator>

#include "libperception/core/Error.h"
#include "libperception/scene/files/RunMark.h"

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

void eachLineOf(const fs::path& path, const std::function<void(const nlohmann::json&)>& each) {
  std::ifstream lines(path, std::ios::binary);
  if (!lines) throw DataError(path.string() + ": cannot be read");
  lines.exceptions(std::ios::badbit);  // a lack of memory is no end
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line);) {
    nlohmann::json value;
    ++number;
    try {
      value = nlohmann::json::parse(line);
    } catch (const nlohmann::json::exception& error) {
      throw DataError(fmt::format("{}: line {}: no JSON: {}", path.string(), number, error.what()));
    }
    each(value);
  }
}

bool isOfRuns(const fs::path& path, const std::vector<std::string>& ids) {
  const std::vector<std::string> said = markedRunsOf(path.string());
  if (said.empty()) return false;
  for (const std::string& id : ids) {
    if (std::find(said.begin(), said.end(), id) == said.end()) {
      throw DataError(fmt::format("{}: is of run {}, expected run {}: make it again, or remove it",
                                  path.string(), fmt::join(said, " and "), id));
    }
  }
  return true;
}

nlohmann::json figuresOf(const fs::path& report, const std::string& id) {
  const nlohmann::json json = jsonOf(report);
  if (!isOfRuns(report, {id})) return nullptr;
  const auto runs = json.find("runs");
  if (runs != json.end() && runs->is_array()) {
    for (const auto& run : *runs) {
      if (run.is_object() && run.contains("run") && run["run"] == runMark({id})) return run;
    }
  }
  return nullptr;  // one of pooled trials: it has no figures of its own
}

}  // namespace perception
