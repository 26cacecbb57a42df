#pragma once
#include <memory>
#include <string>

#include "libperception/interop/bags/ReadingBag.h"

namespace perception {

/// A recording of ROS 2 in an sqlite file (rosbag2_storage_sqlite3: tables topics and messages;
/// message_definitions where there is one). `name`: for messages to people; `path`: the file, which
/// is opened read-only and never changed. Messages come in the order of their rows. Of a
/// write-ahead log beside the file what was committed is read too, if its folder can be written:
/// sqlite keeps an index of it there for as long as the file is open. Rows on damaged pages are
/// left out. Throws DataError: no such tables.
std::unique_ptr<ReadingBag> sqliteBag(const std::string& name, const std::string& path);

}  // namespace perception
