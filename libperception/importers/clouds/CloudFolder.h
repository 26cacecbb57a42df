#pragma once
#include <string>
#include <vector>

#include "libperception/importers/ImportText.h"

namespace perception {

/// The scans of a folder, and the files of cloudEndings() that are none. Text (.txt, .csv) is of
/// scans where most numbered files are of that ending (.txt: more than twice as many as of any
/// other), and where one file has a digit in its name all scans have one: a README.txt, poses.txt
/// or calib.csv is none.
struct CloudFiles {
  std::vector<FrameFile> scans;
  std::vector<std::string> others;  ///< names, in order
};
/// Throws DataError: no folder, no scan.
CloudFiles cloudFilesIn(const std::string& folder);

/// The endings of a folder's files, for a message that says why it is not read.
std::string whatIsIn(const std::string& folder);
/// The same of one ending, ".las"; empty: it is none of the common formats that are not read.
std::string whyNotRead(const std::string& ending);

}  // namespace perception
