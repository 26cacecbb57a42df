#pragma once
#include <string>

namespace perception {

/// Appends the whole file to `content`, or says why it cannot be had; "": it was read.
std::string readWhole(const std::string& path, std::string& content);

/// The folder of a file; "": the working folder.
std::string folderOf(const std::string& path);

/// A path that starts at `folder`; "": at the working folder.
std::string joined(const std::string& folder, const std::string& path);

/// The same for every path that leads to the file.
std::string identityOf(const std::string& path);

}  // namespace perception
