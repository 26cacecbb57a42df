#pragma once
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/live/LiveFeed.h"
#include "libperception/live/server/LiveServer.h"
#include "libperception/pipeline/LogRun.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// --serve and what belongs to it.
struct ServeOptions {
  std::optional<std::uint16_t> port;  ///< --serve; 0: the system chooses
  std::string address = "127.0.0.1";  ///< --serve-address
  std::string token_file;             ///< --serve-token
  std::vector<std::string> origins;   ///< --serve-origin
  double speed = 0;                   ///< --serve-speed: of a log; 0: as fast as it is tracked

  /// Throws Error for what does not fit together, DataError for the file.
  AccessRules rules() const;
};

/// A run that is watched while it goes on: server, feed, and the speed of a log.
class LiveView {
 public:
  LiveView(const ServeOptions& options, const std::string& log, const std::string& config,
           const std::vector<std::string>& class_names);

  /// Where the page is.
  std::string url() const { return server_.url(); }
  /// The run outlives none of this. `also`: told of each event, too.
  void watch(LogRun& run, EventLog::Listener also = {});
  /// Each scene of the run; waits for its time where a speed is given. Throws Error (kTryAgain).
  void put(const Scene& scene, const LogRun& run);
  /// The run is over: sends what waits, and says who looked on and what was left out.
  std::string end();

 private:
  void waitFor(Stamp stamp);

  double speed_;
  LiveServer server_;
  LiveFeed feed_;
  std::optional<std::chrono::steady_clock::time_point> began_;
  Stamp first_;
};

}  // namespace perception
