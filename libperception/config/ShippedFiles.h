#pragma once
#include <string>

namespace perception {

/// Folder of what comes with the programs, ini/ with its models and rawlogs/: the environment's
/// PERCEPTION_DATA; else, of the folder that holds the program or the library and those above, the
/// next with share/perception/ini (installed) or ini/classes.ini (the tree it was built in); ""
/// where there is none.
std::string shippedFolder();

/// `path` where it exists; else the shipped file of that relative `name`, with or without its
/// leading ini/; else `path`.
std::string foundOrShipped(const std::string& path, const std::string& name);

/// What foundOrShipped() finds in every working folder: a file below shippedFolder() as the path
/// from there, any other path as it is.
std::string shippedName(const std::string& path);

}  // namespace perception
