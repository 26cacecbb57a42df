#pragma once
#include <string>

namespace perception {

/// Appends the whole file to `content`. Returns "" or the reason why it cannot be read.
std::string readWhole(const std::string& path, std::string& content);

/// The folder of a file; "": the working folder.
std::string folderOf(const std::string& path);

/// `path` relative to `folder`; "": to the working folder.
std::string joined(const std::string& folder, const std::string& path);

/// The canonical path: equal for all paths of the same file.
std::string identityOf(const std::string& path);

}  // namespace perception
