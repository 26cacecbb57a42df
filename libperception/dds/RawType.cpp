#include "libperception/dds/RawType.h"

#include <dds/dds.h>
#include <dds/ddsi/ddsi_keyhash.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>
#include <dds/ddsi/q_radmin.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <functional>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/dds/RawTopic.h"

namespace perception {

/// Numbers of a writer rise by one; the first one that comes may be any.
void ReceiveCounts::number(const WriterId& writer, std::int64_t number) {
  constexpr std::size_t kMostWritersOfTopic = 1000;
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto known = next_.find(writer);
  if (known == next_.end()) {
    if (next_.size() < kMostWritersOfTopic) next_.emplace(writer, number + 1);
    return;
  }
  if (number > known->second) lost += static_cast<std::uint64_t>(number - known->second);
  if (number >= known->second) known->second = number + 1;
}

namespace {

Stamp wallClock() {
  using namespace std::chrono;
  return {duration_cast<nanoseconds>(system_clock::now().time_since_epoch()).count()};
}

struct RawType : ddsi_sertype {
  std::shared_ptr<ReceiveCounts> counts;
};

struct RawData : ddsi_serdata {
  std::string bytes;
  Stamp received;
};

const RawData& rawOf(const ddsi_serdata* data) { return *static_cast<const RawData*>(data); }
const RawType& rawOf(const ddsi_sertype* type) { return *static_cast<const RawType*>(type); }

/// An empty one of `size` bytes; null for one that is too long.
RawData* newRaw(const ddsi_sertype* type, ddsi_serdata_kind kind, std::size_t size) {
  auto& counts = *rawOf(type).counts;
  if (kind == SDK_DATA) ++counts.received;
  if (size > RawReader::kLongest || size < 4) {
    ++counts.too_long;
    return nullptr;
  }
  auto* const data = new RawData;
  ddsi_serdata_init(data, type, kind);
  data->hash = type->serdata_basehash;  // no keys: all messages are of one instance
  data->bytes.resize(size);
  data->received = wallClock();
  return data;
}

/// Reads writer and number of a message from the packet in which it (or its first part) came: the
/// head of the packet, then the submessage DATA or DATA_FRAG (OMG's DDSI-RTPS 2.3, 8.3.7 and 9.4).
void countNumber(const nn_rdata& part, ReceiveCounts& counts) {
  constexpr std::size_t kPrefix = 8, kPrefixSize = 12, kFlags = 1, kWriter = 12, kNumber = 16;
  const std::size_t at = NN_RDATA_SUBMSG_OFF(&part);
  if (at == 0 || at + kNumber + 8 > NN_RDATA_PAYLOAD_OFF(&part)) return;
  const unsigned char* const packet = NN_RMSG_PAYLOAD(part.rmsg);
  const unsigned char* const submessage = packet + at;
  ReceiveCounts::WriterId writer;
  std::copy_n(packet + kPrefix, kPrefixSize, writer.begin());
  std::copy_n(submessage + kWriter, writer.size() - kPrefixSize, writer.begin() + kPrefixSize);
  const bool little = (submessage[kFlags] & 1) != 0;
  const auto word = [&](std::size_t from) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i)
      value |= std::uint32_t{submessage[from + i]} << (8 * (little ? i : 3 - i));
    return value;
  };
  const std::uint64_t number = std::uint64_t{word(kNumber)} << 32 | word(kNumber + 4);
  counts.number(writer, static_cast<std::int64_t>(number));
}

ddsi_serdata* fromNetwork(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* part,
                          std::size_t size) {
  if (part != nullptr) countNumber(*part, *rawOf(type).counts);
  RawData* const data = newRaw(type, kind, size);
  std::size_t filled = 0;
  for (; data != nullptr && part != nullptr; part = part->nextfrag) {
    if (part->maxp1 <= filled || part->min > filled) continue;  // parts may overlap
    const unsigned char* const bytes =
        NN_RMSG_PAYLOADOFF(part->rmsg, NN_RDATA_PAYLOAD_OFF(part)) + (filled - part->min);
    const std::size_t count = std::min<std::size_t>(part->maxp1, size) - filled;
    std::memcpy(data->bytes.data() + filled, bytes, count);
    filled += count;
  }
  return data;
}

ddsi_serdata* fromMemory(const ddsi_sertype* type, ddsi_serdata_kind kind, ddsrt_msg_iovlen_t parts,
                         const ddsrt_iovec_t* part, std::size_t size) {
  RawData* const data = newRaw(type, kind, size);
  std::size_t filled = 0;
  for (ddsrt_msg_iovlen_t i = 0; data != nullptr && i < parts; ++i) {
    const std::size_t count = std::min<std::size_t>(part[i].iov_len, size - filled);
    std::memcpy(data->bytes.data() + filled, part[i].iov_base, count);
    filled += count;
  }
  return data;
}

ddsi_serdata* withoutKey(const ddsi_sertype* type) {
  auto* const data = new RawData;
  ddsi_serdata_init(data, type, SDK_KEY);
  data->hash = type->serdata_basehash;
  data->bytes.assign("\0\1\0\0", 4);
  return data;
}

ddsi_serdata* untyped(const ddsi_serdata* from) {
  ddsi_serdata* const data = withoutKey(from->type);
  data->type = nullptr;
  return data;
}

/// The middleware asks for whole words: the last one is filled with zeros.
void copyBytes(const ddsi_serdata* data, std::size_t from, std::size_t count, void* to) {
  const std::string& bytes = rawOf(data).bytes;
  std::memset(to, 0, count);
  if (from < bytes.size())
    std::memcpy(to, bytes.data() + from, std::min(count, bytes.size() - from));
}

ddsi_serdata* lendBytes(const ddsi_serdata* data, std::size_t from, std::size_t count,
                        ddsrt_iovec_t* to) {
  // RawWriter fills the last word, so that what is asked for is there.
  to->iov_base = const_cast<char*>(rawOf(data).bytes.data() + from);
  to->iov_len = static_cast<decltype(to->iov_len)>(count);
  return ddsi_serdata_ref(data);
}

const ddsi_serdata_ops* rawDataOps() {
  static const ddsi_serdata_ops ops = [] {
    ddsi_serdata_ops o{};
    o.eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; };
    o.get_size = [](const ddsi_serdata* d) {
      return static_cast<std::uint32_t>(rawOf(d).bytes.size());
    };
    o.from_ser = &fromNetwork;
    o.from_ser_iov = &fromMemory;
    o.from_keyhash = [](const ddsi_sertype* type, const ddsi_keyhash*) { return withoutKey(type); };
    o.from_sample = [](const ddsi_sertype* type, ddsi_serdata_kind, const void*) {
      return withoutKey(type);
    };
    o.to_ser = &copyBytes;
    o.to_ser_ref = &lendBytes;
    o.to_ser_unref = [](ddsi_serdata* d, const ddsrt_iovec_t*) { ddsi_serdata_unref(d); };
    o.to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; };
    o.to_untyped = &untyped;
    o.untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**, void*) {
      return false;
    };
    o.free = [](ddsi_serdata* d) { delete static_cast<RawData*>(d); };
    o.print = [](const ddsi_sertype*, const ddsi_serdata*, char* to, std::size_t size) {
      if (size > 0) *to = '\0';
      return std::size_t{0};
    };
    o.get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* to, bool) {
      std::memset(to, 0, sizeof *to);
    };
    return o;
  }();
  return &ops;
}

const ddsi_sertype_ops* rawTypeOps() {
  static const ddsi_sertype_ops ops = [] {
    ddsi_sertype_ops o{};
    o.version = &ddsi_sertype_v0;
    o.free = [](ddsi_sertype* type) {
      ddsi_sertype_fini(type);
      delete static_cast<RawType*>(type);
    };
    // Each topic has its own, which counts.
    o.equal = [](const ddsi_sertype* a, const ddsi_sertype* b) { return a == b; };
    o.hash = [](const ddsi_sertype* type) {
      return static_cast<std::uint32_t>(std::hash<const void*>()(type));
    };
    o.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
    o.realloc_samples = [](void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {};
    o.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
    return o;
  }();
  return &ops;
}

}  // namespace

int makeRawTopic(const Network& network, const std::string& name, const std::string& type_name,
                 std::shared_ptr<ReceiveCounts> counts, const ddsi_sertype*& type) {
  auto* const made = new RawType;
  made->counts = std::move(counts);
  ddsi_sertype_init(made, type_name.c_str(), rawTypeOps(), rawDataOps(), true);
  ddsi_sertype* given = made;
  const int topic = dds_create_topic_sertype(network.participant(), name.c_str(), &given, nullptr,
                                             nullptr, nullptr);
  if (topic < 0) ddsi_sertype_unref(made);
  type = given;
  if (topic < 0)
    throw Error(ExitCode::kUnavailable,
                fmt::format("DDS: topic {}: {}", name, dds_strretcode(-topic)));
  return topic;
}

ddsi_serdata* makeRawMessage(const ddsi_sertype* type, std::string_view cdr) {
  constexpr std::size_t kWord = 4;
  const std::size_t size = (cdr.size() + kWord - 1) / kWord * kWord;
  RawData* const data = newRaw(type, SDK_DATA, size);
  if (data == nullptr) return nullptr;
  std::memcpy(data->bytes.data(), cdr.data(), cdr.size());
  data->bytes[3] = static_cast<char>(size - cdr.size());  // how many bytes fill the last word
  return data;
}

const std::string& bytesOf(const ddsi_serdata* message) { return rawOf(message).bytes; }

Stamp receivedOf(const ddsi_serdata* message) { return rawOf(message).received; }

}  // namespace perception
