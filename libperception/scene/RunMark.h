#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// What a product of a run (picture, film, page, scene file) says of which run it is, as text that
/// any reader of its bytes finds: "perception run ID", one for each run in it. Where a format has
/// room for a remark, it stands there: PNG tEXt, JPEG COM, MP4 comment, gzip comment, OctoMap's
/// lines of "#". Empty ids have none.
std::string runMark(const std::vector<std::string>& ids);

/// The ids in the marks of a file's bytes, in order of appearance, each once.
std::vector<std::string> markedRuns(std::string_view bytes);
/// The same of a file, read part by part. Throws DataError.
std::vector<std::string> markedRunsOf(const std::string& path);

/// The file's bytes with the mark at its place; unchanged for an empty mark and for formats that
/// have none. The format is told by its first bytes: PNG, JPEG, gzip, OctoMap.
std::string withMark(std::string bytes, const std::string& mark);
/// Marks a file that others have written. Throws DataError, OutputError.
void markFile(const std::string& path, const std::string& mark);
/// The same of all PNG files below a folder.
void markPictures(const std::string& dir, const std::string& mark);

}  // namespace perception
