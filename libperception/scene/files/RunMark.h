#pragma once
#include <string>
#include <vector>

namespace perception {

/// The mark by which a product of a run (picture, film, page, scene file) names its run: the text
/// "perception run ID", once for each run in it, which any reader of the bytes finds. It stands
/// where the format has room for a remark: PNG tEXt, JPEG COM, MP4 comment, gzip comment, OctoMap's
/// lines of "#". Empty ids give no mark.
std::string runMark(const std::vector<std::string>& ids);

/// The ids in the marks of a file, in order of appearance, each once. Throws DataError.
std::vector<std::string> markedRunsOf(const std::string& path);

/// The file's bytes with the mark at its place; unchanged for an empty mark and for formats that
/// have no room for it. The first bytes show the format: PNG, JPEG, gzip, OctoMap.
std::string withMark(std::string bytes, const std::string& mark);
/// Marks a file that others have written. Throws DataError, OutputError.
void markFile(const std::string& path, const std::string& mark);
/// The same of all PNG files below a folder.
void markPictures(const std::string& dir, const std::string& mark);

}  // namespace perception
