#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/pipeline/PipelineSetup.h"

namespace perception {

/// The observations of a log by sensor label and class: how many, from when to when.
class LogContents {
 public:
  void look(const mrpt::obs::CObservation& observation);
  /// One line: labels with class and number.
  std::string text() const;
  /// A row per label and class: number, rate, first and last time in the log.
  std::vector<std::vector<std::string>> rows() const;
  static std::vector<std::string> columns();  ///< names of the columns of rows()
  /// The rows as text.
  std::string table() const;

 private:
  struct Entry {
    std::uint64_t count = 0;
    std::optional<Stamp> first, last;
  };
  using Kind = std::pair<std::string, std::string>;  ///< label, class

  std::map<Kind, Entry> entries_;
  std::uint64_t others_ = 0;  ///< of labels beyond the most that are kept
  std::optional<Stamp> first_;
};

/// Why no scene came of a log: what it holds, what the configuration wants, how it ended.
std::string noSceneMessage(const std::string& log, const LogContents& contents,
                           const PipelineSetup& setup, const std::string& end_message);

}  // namespace perception
