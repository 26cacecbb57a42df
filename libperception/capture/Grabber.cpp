#include "libperception/capture/Grabber.h"

#include <fmt/format.h>
#include <mrpt/obs/CObservationComment.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "libperception/capture/simulated/DeviceSimulator.h"
#include "libperception/core/Error.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kMostUnpublished = 1000;  ///< that wait
constexpr auto kWait = milliseconds(10);
constexpr auto kSilence = milliseconds(20);  ///< after which a stream is told that time goes on

/// What a driver knows of its packets.
void addPackets(const LedgerSource& source, nlohmann::json& line) {
  const PacketLedger p = source.packets();
  line["packets"] = {{"received", p.received},
                     {"damaged", p.damaged},
                     {"lost", p.lost},
                     {"repeated", p.repeated},
                     {"late", p.late},
                     {"restarts", p.restarts},
                     {"refused", source.refused()},
                     {"overrun", source.overrun()},
                     {"lost_numbers", source.lostPackets()}};
  const ClockLedger clock = source.clock();
  line["clock"] = {{"state", nameOf(clock.state)}, {"steps", clock.steps}};
  if (clock.offset) line["clock"]["offset_s"] = *clock.offset;
  line["events"] = source.warnings();
  if (!source.simulator()) return;
  const SentLedger& s = source.simulator()->ledger();
  line["simulator"] = {{"made", s.made},       {"dropped", s.dropped}, {"repeated", s.repeated},
                       {"swapped", s.swapped}, {"torn", s.torn},       {"resent", s.resent},
                       {"sent", s.sent},       {"missing", s.missing}};
}

ChunkLimits limitsOf(const std::string& ini) {
  const auto opened = openCaptureIni(ini);
  const auto& config = *opened;
  ChunkLimits limits;
  limits.seconds = config.read_double("global", "chunk_seconds", limits.seconds);
  limits.bytes = static_cast<std::uint64_t>(
      config.read_double("global", "chunk_mb", static_cast<double>(limits.bytes) * 1e-6) * 1e6);
  limits.free_bytes = static_cast<std::uint64_t>(
      config.read_double("global", "free_mb", static_cast<double>(limits.free_bytes) * 1e-6) * 1e6);
  limits.gzip_level = config.read_int("global", "rawlog_GZ_compress_level", limits.gzip_level);
  if (!(limits.seconds > 0) || limits.bytes == 0)
    throw ConfigError(ini + ": [global] chunk_seconds and chunk_mb must be above 0");
  return limits;
}

/// [bytes] of observations that wait for the disk.
std::uint64_t queueOf(const std::string& ini) {
  const double megabytes = openCaptureIni(ini)->read_double("global", "queue_mb", 2000);
  if (!(megabytes > 0)) throw ConfigError(ini + ": [global] queue_mb must be above 0");
  return static_cast<std::uint64_t>(megabytes * 1e6);
}

std::size_t streamLimitOf(const std::string& ini) {
  const auto limit = openCaptureIni(ini)->read_uint64_t("global", "stream_limit", 200);
  if (limit == 0) throw ConfigError(ini + ": [global] stream_limit must be above 0");
  return limit;
}

}  // namespace

Grabber::Grabber(const std::string& ini, const GrabberOutputs& outputs) : drivers_(ini) {
  for (std::size_t i = 0; i < drivers_.size(); ++i) ledgers_[drivers_.label(i)];
  if (!outputs.folder.empty()) startRecord(outputs.folder, limitsOf(ini), queueOf(ini));
  if (!outputs.stream.empty()) startStream(outputs.stream, streamLimitOf(ini));
  if (outputs.network) startPublishing(*outputs.network);
}

void Grabber::startPublishing(const NetworkName& network) {
  publisher_ = std::make_unique<ObservationPublisher>(network);
  ros_ = std::make_unique<RosTopics>(RosTopics::Params{network, {}});
  Outlet::Params params;
  params.limit = kMostUnpublished;
  params.take = [this](const Drivers::Arrival& arrival, std::uint64_t) {
    if (!publisher_->publish(*arrival.observation)) ++unpublished_;
    if (!isSensorData(*arrival.observation)) return;
    if (const auto frame = frameFromObservation(*arrival.observation)) ros_->publish(*frame);
  };
  network_ = std::make_unique<Outlet>(std::move(params));
}

void Grabber::startRecord(const std::string& folder, const ChunkLimits& limits,
                          std::uint64_t queue_bytes) {
  log_.emplace(folder, limits);
  const auto note = [this] { bytes_ = log_->bytes(), chunks_ = log_->chunks(); };
  Outlet::Params params;
  params.take = [this, note](const Drivers::Arrival& arrival, std::uint64_t) {
    log_->write(*arrival.observation);
    note();
  };
  params.tend = [this, note] {
    log_->tend();
    note();
  };
  params.most_bytes = queue_bytes;
  params.left_out = [this](const Drivers::Arrival& arrival) {
    SensorLedger& ledger = ledgers_[drivers_.label(arrival.driver)];
    --ledger.written;
    ++ledger.left_out;
    if (const auto stamp = toStamp(arrival.observation->timestamp))
      ledger.left_out_stamps.push_back(stamp->ns);
  };
  record_ = std::make_unique<Outlet>(std::move(params));
}

void Grabber::startStream(const std::string& path, std::size_t limit) {
  writer_.emplace(path);
  Outlet::Params params;
  params.limit = limit;
  params.take = [this](const Drivers::Arrival& arrival, std::uint64_t dropped) {
    if (!reader_gone_ &&
        !writer_->write({arrival.observation, arrival.at, static_cast<std::uint32_t>(dropped)}))
      reader_gone_ = true;
  };
  stream_ = std::make_unique<Outlet>(std::move(params));
}

void Grabber::put(const Drivers::Arrival& arrival) {
  if (stream_) stream_->put(arrival);
  if (network_) network_->put(arrival);
  if (record_) record_->put(arrival);
}

void Grabber::count(const Drivers::Arrival& arrival) {
  SensorLedger& ledger = ledgers_[drivers_.label(arrival.driver)];
  ++ledger.written;
  const auto stamp = arrival.observation->timestamp;
  auto& last = last_[arrival.observation->sensorLabel];
  if (stamp < last) ++ledger.late;
  last = std::max(last, stamp);
  if (!newest_ || stamp > newest_->stamp) newest_ = {stamp, arrival.at};
}

void Grabber::pass(std::vector<Drivers::Arrival> arrivals) {
  for (const Drivers::Arrival& arrival : arrivals) {
    count(arrival);
    put(arrival);
  }
  if (!arrivals.empty()) last_passed_ = steady_clock::now();
}

/// A reader waits for what may come late until the time has passed; in silence, nothing else would
/// say that it has.
void Grabber::passTime() {
  const auto now = steady_clock::now();
  if (!stream_ || !newest_ || now - last_passed_ < kSilence) return;
  auto comment = std::make_shared<mrpt::obs::CObservationComment>();
  comment->text = kClockText;
  comment->timestamp =
      newest_->stamp + std::chrono::duration_cast<mrpt::Clock::duration>(now - newest_->at);
  put({comment, 0, now});
  last_passed_ = now;
}

void Grabber::run(const std::function<bool()>& done, const std::function<void()>& tick) {
  auto next_tick = steady_clock::now() + std::chrono::seconds(1);
  try {
    while (!done() && !reader_gone_) {
      pass(drivers_.take(kWait));
      passTime();
      if (record_) record_->check();
      if (steady_clock::now() < next_tick) continue;
      next_tick += std::chrono::seconds(1);
      tick();
    }
  } catch (const OutputError&) {
    drivers_.end();
    noteLedgers();  // a line fits where no scan does
    throw;
  }
  drivers_.end();
  pass(drivers_.take(milliseconds(0)));
  if (stream_) stream_->close();
  if (network_) network_->close();
  if (!record_) return;
  record_->close();
  log_->close();
  bytes_ = log_->bytes(), chunks_ = log_->chunks();
  noteLedgers();
}

/// None of a driver that does not return: it may still change its ledger.
const LedgerSource* Grabber::ledgerOf(std::size_t i) const {
  return drivers_.isOver(i) ? dynamic_cast<const LedgerSource*>(&drivers_[i]) : nullptr;
}

void Grabber::noteLedgers() {
  if (!log_) return;
  for (std::size_t i = 0; i < drivers_.size(); ++i) {
    const SensorLedger& ledger = ledgers_[drivers_.label(i)];
    nlohmann::json line{
        {"sensor", drivers_.label(i)}, {"written", ledger.written}, {"late", ledger.late}};
    if (ledger.left_out > 0) {
      line["left_out"] = ledger.left_out;
      line["left_out_stamps_ns"] = ledger.left_out_stamps;
    }
    if (const auto* source = ledgerOf(i)) addPackets(*source, line);
    log_->note(line.dump());
  }
}

std::vector<std::string> Grabber::notes() const {
  std::vector<std::string> all;
  for (std::size_t i = 0; i < drivers_.size(); ++i) {
    const auto* source = ledgerOf(i);
    if (!source) continue;
    for (const std::string& note : source->notes()) all.push_back(note);
  }
  return all;
}

std::vector<std::string> Grabber::warnings() const {
  std::vector<std::string> all = drivers_.faults();
  if (stream_ && stream_->dropped() > 0)
    all.push_back(fmt::format("{} observations were not streamed: the reader was too slow",
                              stream_->dropped()));
  if (const auto missed = unpublished_ + (network_ ? network_->dropped() : 0); missed > 0)
    all.push_back(fmt::format("{} observations were not published: a reader was too slow", missed));
  for (const auto& [label, ledger] : ledgers_)
    if (ledger.left_out > 0)
      all.push_back(fmt::format("{}: {} observations were not recorded: the disk was too slow",
                                label, ledger.left_out));
  for (std::size_t i = 0; i < drivers_.size(); ++i) {
    const auto* source = ledgerOf(i);
    if (!source) continue;
    for (const std::string& warning : source->warnings()) all.push_back(warning);
    const PacketLedger p = source->packets();
    if (source->overrun() > 0)
      all.push_back(fmt::format("{}: this computer had no room for {} packets", drivers_.label(i),
                                source->overrun()));
    if (source->refused() > 0)
      all.push_back(fmt::format("{}: {} packets of another sender refused", drivers_.label(i),
                                source->refused()));
    if (p.damaged > 0)
      all.push_back(
          fmt::format("{}: {} of {} packets damaged", drivers_.label(i), p.damaged, p.received));
    if (p.lost > 0)
      all.push_back(fmt::format("{}: {} of {} packets lost", drivers_.label(i), p.lost,
                                p.lost + p.received - p.repeated));
  }
  return all;
}

}  // namespace perception
