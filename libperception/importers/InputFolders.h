#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/importers/InputKind.h"

namespace perception {

// Parts of inputKind().

/// A folder by the names in it; empty: not known.
std::optional<InputKind> folderKind(const std::filesystem::path& folder);
/// One of clouds; empty: there are none.
std::optional<InputKind> cloudFolder(const std::filesystem::path& folder);
/// A file or folder of bags.
InputKind recordingOfRos(const std::filesystem::path& path);

/// A path as a word of a command line.
std::string shellWord(const std::filesystem::path& path);
/// "perception-import WORDS -o NAME.rawlog", the name after the path.
std::string importCommand(const std::string& words, const std::filesystem::path& path);
/// Names in a folder, in order; folders with a slash behind.
std::vector<std::string> namesInFolder(const std::filesystem::path& folder);
bool hasEnding(const std::string& text, std::string_view end);

}  // namespace perception
