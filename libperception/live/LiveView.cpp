#include "libperception/live/LiveView.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <thread>

#include "libperception/core/Error.h"
#include "libperception/live/LivePage.h"
#include "libperception/pipeline/output/Progress.h"

namespace perception {
namespace {

constexpr std::chrono::milliseconds kLongestWait{50};  // between looks for a signal

LiveServer::Params serverOf(const ServeOptions& options, const std::string& log) {
  LiveServer::Params params;
  params.access = options.rules();
  params.port = options.port.value_or(0);
  params.name = log;
  params.page = livePage(log);
  return params;
}

std::string fileNameOf(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

}  // namespace

AccessRules ServeOptions::rules() const {
  AccessRules rules;
  rules.address = address;
  if (!token_file.empty()) rules.token = readToken(token_file);
  rules.origins = origins;
  checkRules(rules);
  return rules;
}

LiveView::LiveView(const ServeOptions& options, const std::string& log, const std::string& config,
                   const std::vector<std::string>& class_names)
    : speed_(options.speed),
      server_(serverOf(options, fileNameOf(log))),
      feed_(server_, {fileNameOf(log), fileNameOf(config), class_names}) {}

void LiveView::watch(LogRun& run, EventLog::Listener also) {
  run.watch(feed_, [this, also = std::move(also)](std::optional<Stamp> stamp,
                                                  const nlohmann::ordered_json& content) {
    feed_.onEvent(stamp, content);
    if (also) also(stamp, content);
  });
}

void LiveView::put(const Scene& scene, const LogRun& run) {
  if (speed_ > 0) waitFor(scene.stamp);
  feed_.put(scene, {*run.firstStamp(), run.latency(), run.simulated(), run.grid()});
}

void LiveView::waitFor(Stamp stamp) {
  const auto now = std::chrono::steady_clock::now();
  if (!began_ || stamp < first_) {
    began_ = now;
    first_ = stamp;
  }
  const std::chrono::duration<double> due((stamp - first_) / speed_);
  for (;;) {
    stopIfAsked();
    const auto left = due - (std::chrono::steady_clock::now() - *began_);
    if (left.count() <= 0) return;
    std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(left, kLongestWait));
  }
}

std::string LiveView::end() {
  feed_.end();
  server_.finish();
  const LiveTotals t = server_.totals();
  return fmt::format(
      "watched by {} pages and {} other clients: {} messages sent, {} left out for slow readers, "
      "{} scenes not shown, {} requests refused{}",
      t.pages, t.others, t.sent, t.dropped, feed_.skipped(), t.refused,
      t.faults > 0 ? fmt::format(", {} internal faults", t.faults) : "");
}

}  // namespace perception
