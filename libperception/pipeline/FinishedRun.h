#pragma once
#include <string>
#include <vector>

namespace perception {

/// SHA-256 of what the results of a run are a function of: the log, the effective INI, the files
/// that it names, the version of the program. 64 hexadecimal digits; empty
/// if the log is no regular file. Throws DataError.
std::string runHash(const std::string& log, const std::string& effective_ini,
                    const std::string& version);

/// True if `dir` holds the finished run of this hash: there is nothing to do. With `overwrite` there
/// always is; without, throws Error (kBadConfig) if it holds another one.
bool isFinished(const std::string& dir, const std::string& hash, bool overwrite);

/// Results in `dir` of earlier programs on an earlier run, relative: tables, page, pictures, film,
/// evaluation. They would be taken as those of the next run.
std::vector<std::string> productsIn(const std::string& dir);

}  // namespace perception
