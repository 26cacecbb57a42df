#include "libperception/capture/ros/CRosSensor.h"

#include <dds/dds.h>
#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>

#include <algorithm>
#include <cstdio>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {

IMPLEMENTS_GENERIC_SENSOR(CRosSensor, perception)

namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds(100);
constexpr auto kLongestWait = DDS_MSECS(10);
// Messages that may wait for us: scans and images of a second or two, others of some seconds.
constexpr int kLargeDepth = 30, kSmallDepth = 2000;

Stamp wallClockNow() {
  using namespace std::chrono;
  return {duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count()};
}

void addLedger(RawReader::Ledger& to, const RawReader::Ledger& more) {
  to.received += more.received;
  to.lost += more.lost;
  to.overrun += more.overrun;
  to.too_long += more.too_long;
}

}  // namespace

CRosSensor::~CRosSensor() {
  sources_.clear();
  if (waitset_ > 0) dds_delete(waitset_);
}

// MRPT has read sensorLabel and process_rate before.
void CRosSensor::loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& config,
                                           const std::string& section) {
  ini_ = config.read_string(section, "ini", "");
  Config own = ini_.empty() ? Config::fromText("", "(no INI)") : Config::fromFile(ini_);
  intake_ = std::make_unique<RosIntake>(
      own, [this](std::shared_ptr<mrpt::obs::CObservation> o) { appendObservation(o); });
  m_process_rate = 1000;  // it waits for data by itself
}

void CRosSensor::initialize() {
  network_ = Network::join(NetworkName::parse(intake_->graph().network));
  graph_ = std::make_unique<RosGraph>(network_);
  waitset_ = dds_create_waitset(network_->participant());
  if (waitset_ < 0) throw Error(ExitCode::kUnavailable, "DDS: no waitset");
  m_state = ssWorking;
}

void CRosSensor::close(Source& source) {
  if (!source.reader) return;
  addLedger(source.before, source.reader->ledger());
  dds_waitset_detach(waitset_, source.reader->entity());
  source.reader.reset();
}

RawReader::Ledger CRosSensor::Source::ledger() const {
  RawReader::Ledger all = before;
  if (reader) addLedger(all, reader->ledger());
  return all;
}

void CRosSensor::open(const std::string& topic, const GraphTopic& found) {
  Source& source = sources_[topic];
  if (source.reader && source.type == found.type && source.reader->quality() == found.quality)
    return;
  receive();  // what still waits in the reader
  close(source);
  source.type = found.type;
  source.reader = std::make_unique<RawReader>(
      network_, wireTopicOf(topic), wireTypeOf(found.type), found.quality,
      RosIntake::isLarge(found.type) ? kLargeDepth : kSmallDepth);
  dds_waitset_attach(waitset_, source.reader->entity(), source.reader->entity());
  fmt::print(stderr, "{}: {}: {}, {} writers, {}{}\n", m_sensorLabel, topic, found.type,
             found.writers, found.quality.reliable ? "reliable" : "best effort",
             found.quality.latched ? ", latched" : "");
  if (found.others > 0)
    fmt::print(stderr, "{}: {}: {} writers of another type are not read\n", m_sensorLabel, topic,
               found.others);
}

/// Opens readers of what is new. A topic whose writers all went keeps its reader: they may come
/// back.
void CRosSensor::lookAround() {
  const auto now = std::chrono::steady_clock::now();
  if (now < next_look_) return;
  next_look_ = now + kBetweenLooks;
  auto topics = graph_->look();
  if (topics == known_) return;
  for (const auto& [topic, found] : topics)
    if (intake_->wants(topic, found.type)) open(topic, found);
  known_ = std::move(topics);
}

void CRosSensor::receive() {
  struct Came {
    const std::string* topic;
    const std::string* type;
    RawReader::Message message;
  };
  std::vector<Came> all;
  for (auto& [topic, source] : sources_) {
    if (!source.reader) continue;
    for (RawReader::Message& message : source.reader->take())
      all.push_back({&topic, &source.type, std::move(message)});
  }
  std::stable_sort(all.begin(), all.end(), [](const Came& a, const Came& b) {
    return a.message.received < b.message.received;
  });
  for (Came& came : all)
    intake_->take(*came.topic, *came.type, std::move(came.message.bytes), came.message.received);
}

void CRosSensor::doProcess() {
  lookAround();
  dds_waitset_wait(waitset_, nullptr, 0, kLongestWait);
  receive();
  intake_->tend(wallClockNow());
}

void CRosSensor::endCapture() {
  receive();
  intake_->finish();
}

RawReader::Ledger CRosSensor::ledgerOfAll() const {
  RawReader::Ledger all;
  for (const auto& row : sources_) addLedger(all, row.second.ledger());
  return all;
}

PacketLedger CRosSensor::packets() const {
  const RawReader::Ledger all = ledgerOfAll();
  PacketLedger packets;
  packets.received = all.received;
  packets.lost = all.lost;
  packets.damaged = intake_->unreadable() + all.too_long;
  packets.late = intake_->late();
  return packets;
}

std::vector<std::string> CRosSensor::warnings() const {
  std::vector<std::string> all;
  for (const auto& [topic, source] : sources_) {
    const RawReader::Ledger ledger = source.ledger();
    if (ledger.lost > 0) all.push_back(fmt::format("{}: {} messages lost", topic, ledger.lost));
    if (ledger.overrun > 0)
      all.push_back(
          fmt::format("{}: {} messages came faster than they were read", topic, ledger.overrun));
    if (ledger.too_long > 0)
      all.push_back(fmt::format("{}: {} messages of more than {} MB left out", topic,
                                ledger.too_long, RawReader::kLongest / 1'000'000));
  }
  for (const std::string& warning : intake_->warnings()) all.push_back(warning);
  if (sources_.empty())
    all.push_back(fmt::format("no topic that is read was written on {}", intake_->graph().network));
  return all;
}

std::vector<std::string> CRosSensor::notes() const { return intake_->notes(); }

}  // namespace perception
