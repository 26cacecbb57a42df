#include "libperception/pipeline/input/LiveInput.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/pipeline/output/Progress.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

constexpr char kRosGraph[] = "ros2:";
constexpr int kLookMs = 50;  ///< how often a signal is looked for

/// Beside this program, else on PATH.
std::string grabberProgram() {
  std::error_code ignored;
  const fs::path beside =
      fs::read_symlink("/proc/self/exe", ignored).parent_path() / "perception-grabber";
  return fs::exists(beside, ignored) ? beside.string() : "perception-grabber";
}

}  // namespace

std::optional<std::string> liveIniOf(const std::string& input) {
  constexpr char kLive[] = "live:";
  if (isOfRosGraph(input)) return input;
  if (input.rfind(kLive, 0) != 0) return std::nullopt;
  return input.substr(sizeof kLive - 1);
}

bool isOfRosGraph(const std::string& input) { return input.rfind(kRosGraph, 0) == 0; }

std::string rosGraphIniOf(const std::string& input) { return input.substr(sizeof kRosGraph - 1); }

LiveInput::LiveInput(Params params) : params_(std::move(params)) {
  registerPerceptionClasses();
  const std::string file = isOfRosGraph(params_.ini) ? rosGraphIniOf(params_.ini) : params_.ini;
  const bool none_needed = isOfRosGraph(params_.ini) && file.empty();
  if (!none_needed && !fs::is_regular_file(file))
    throw DataError(file + ": no such file", ExitCode::kNoInput);
  int ends[2];
  if (::pipe(ends) != 0)
    throw Error(ExitCode::kUnavailable, fmt::format("no pipe: {}", std::strerror(errno)));
  ::fcntl(ends[0], F_SETFD, FD_CLOEXEC);
  reader_ = std::make_unique<StreamReader>(ends[0]);
  ChildCommand command;
  command.words = {grabberProgram(), "-c", params_.ini, "--stream",
                   fmt::format("/dev/fd/{}", ends[1])};
  if (params_.seconds > 0)
    command.words.insert(command.words.end(), {"--duration", fmt::format("{}", params_.seconds)});
  if (!params_.record.empty()) command.words.insert(command.words.end(), {"-o", params_.record});
  try {
    grabber_ = std::make_unique<ChildProcess>(command);
  } catch (...) {
    ::close(ends[1]);
    throw;
  }
  ::close(ends[1]);  // the grabber has it
}

std::shared_ptr<mrpt::obs::CObservation> LiveInput::next() {
  try {
    for (;;) {
      if (stopAsked()) grabber_->stop();
      switch (reader_->read(entry_, kLookMs)) {
        case StreamReader::Result::kNothing:
          continue;
        case StreamReader::Result::kEnd:
          finish("");
          return nullptr;
        case StreamReader::Result::kEntry:
          ++entries_;
          if (const auto stamp = toStamp(entry_.observation->timestamp);
              stamp && (!last_stamp_ || *last_stamp_ < *stamp))
            last_stamp_ = stamp;
          return entry_.observation;
      }
    }
  } catch (const std::exception& error) {
    finish(error.what());
    return nullptr;
  }
}

void LiveInput::finish(const std::string& fault) {
  grabber_->stop();
  grabber_->wait();
  const int code = grabber_->exitCode();
  const bool ended = code == 0 || code == static_cast<int>(ExitCode::kTryAgain);
  if (!fault.empty()) {
    end_message_ = fmt::format("{}: {}", params_.ini, fault);
  } else if (code == static_cast<int>(ExitCode::kDataWarnings)) {
    end_message_ = params_.ini + ": sensors lost data, as perception-grabber says";
  } else if (!ended) {
    end_message_ = fmt::format("{}: perception-grabber ended with code {}", params_.ini, code);
  }
}

std::optional<std::chrono::steady_clock::time_point> LiveInput::arrival() const {
  return entry_.arrival;
}

}  // namespace perception
