#include "libperception/dds/RawTopic.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <fmt/format.h>

#include <array>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/dds/RawType.h"

namespace perception {
namespace {

constexpr std::size_t kTakenAtOnce = 32;
constexpr auto kBlocking = DDS_MSECS(10);
constexpr int kHistoryOfWriters = 50;

int checkedRaw(int entity, const std::string& what) {
  if (entity < 0)
    throw Error(ExitCode::kUnavailable, fmt::format("DDS: {}: {}", what, dds_strretcode(-entity)));
  return entity;
}

struct RawQos {
  RawQos(TopicQuality quality, int depth) {
    dds_qset_reliability(
        qos, quality.reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, kBlocking);
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
    dds_qset_durability(qos,
                        quality.latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  }
  ~RawQos() { dds_delete_qos(qos); }
  RawQos(const RawQos&) = delete;
  RawQos& operator=(const RawQos&) = delete;

  dds_qos_t* qos = dds_create_qos();
};

}  // namespace

RawReader::RawReader(std::shared_ptr<Network> network, const std::string& topic,
                     const std::string& type, TopicQuality quality, int depth)
    : network_(std::move(network)), quality_(quality), counts_(std::make_shared<ReceiveCounts>()) {
  const ddsi_sertype* made = nullptr;
  topic_ = makeRawTopic(*network_, topic, type, counts_, made);
  const RawQos qos(quality, depth);
  reader_ = dds_create_reader(network_->participant(), topic_, qos.qos, nullptr);
  if (reader_ < 0) dds_delete(topic_);
  checkedRaw(reader_, "reader of " + topic);
  dds_set_status_mask(reader_, DDS_DATA_AVAILABLE_STATUS);
}

RawReader::~RawReader() {
  dds_delete(reader_);
  dds_delete(topic_);
}

std::vector<RawReader::Message> RawReader::take() {
  std::vector<Message> out;
  std::array<ddsi_serdata*, kTakenAtOnce> data{};
  std::array<dds_sample_info_t, kTakenAtOnce> infos{};
  for (;;) {
    const int count = dds_takecdr(reader_, data.data(), kTakenAtOnce, infos.data(), DDS_ANY_STATE);
    for (int i = 0; i < count; ++i) {
      const auto at = static_cast<std::size_t>(i);
      if (infos[at].valid_data) {
        out.push_back({bytesOf(data[at]), receivedOf(data[at])});
        ++taken_;
      }
      ddsi_serdata_unref(data[at]);
    }
    if (count < static_cast<int>(kTakenAtOnce)) return out;
  }
}

RawReader::Ledger RawReader::ledger() const {
  Ledger ledger;
  ledger.received = counts_->received;
  ledger.too_long = counts_->too_long;
  const std::uint64_t given = taken_ + ledger.too_long;
  ledger.overrun = ledger.received > given ? ledger.received - given : 0;
  ledger.lost = counts_->lost;
  return ledger;
}

RawWriter::RawWriter(std::shared_ptr<Network> network, const std::string& topic,
                     const std::string& type, TopicQuality quality)
    : network_(std::move(network)) {
  const ddsi_sertype* made = nullptr;
  topic_ = makeRawTopic(*network_, topic, type, std::make_shared<ReceiveCounts>(), made);
  const RawQos qos(quality, quality.latched ? 1 : kHistoryOfWriters);
  writer_ = dds_create_writer(network_->participant(), topic_, qos.qos, nullptr);
  if (writer_ < 0) dds_delete(topic_);
  checkedRaw(writer_, "writer of " + topic);
  type_ = made;
}

RawWriter::~RawWriter() {
  dds_delete(writer_);
  dds_delete(topic_);
}

bool RawWriter::hasReaders() const {
  dds_publication_matched_status_t matched{};
  return dds_get_publication_matched_status(writer_, &matched) != DDS_RETCODE_OK ||
         matched.current_count > 0;
}

bool RawWriter::write(std::string_view cdr) {
  ddsi_serdata* const message = makeRawMessage(static_cast<const ddsi_sertype*>(type_), cdr);
  return message != nullptr && dds_writecdr(writer_, message) == DDS_RETCODE_OK;
}

}  // namespace perception
