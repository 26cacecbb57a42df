#include "libperception/sensors/rawlog/RawlogReader.h"

#include <fmt/format.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/rtti/CObject.h>

#include <algorithm>
#include <new>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/system/MemoryLimit.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/images/JpegErrors.h"
#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/CRawlogInput.h"
#include "libperception/sensors/rawlog/CheckedAllocation.h"

namespace perception {

namespace {

/// Header of an entry: length of the class name (one byte with bit 7 set since MRPT 0.5.5, formerly
/// four bytes), name, version.
struct EntryHeader {
  std::string class_name;
};

constexpr std::size_t kHeaderBytes = 4 + 127;
/// [MiB] of memory that reading one entry may take: 15 million points and half as much again.
constexpr std::uint64_t kLargestEntry = 400;

bool isNameCharacter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
         c == ':' || c == '<' || c == '>' || c == ',' || c == ' ';
}

/// Empty when the bytes are no header of an entry. `complete` is false when there are too few of
/// them.
std::optional<EntryHeader> parseHeader(const std::string& bytes, bool& complete) {
  complete = true;
  if (bytes.empty()) return {};
  const auto first = static_cast<unsigned char>(bytes[0]);
  std::size_t begin = 1;
  if ((first & 0x80) == 0) {
    begin = 4;
    if (std::any_of(bytes.begin() + 1,
                    bytes.begin() + static_cast<std::ptrdiff_t>(std::min(bytes.size(), begin)),
                    [](char c) { return c != 0; })) {
      return {};
    }
  }
  const std::size_t length = first & 0x7f;
  const std::string name = bytes.size() > begin ? bytes.substr(begin, length) : "";
  if (length < 2 || !std::all_of(name.begin(), name.end(), isNameCharacter)) return {};
  complete = name.size() == length;
  return EntryHeader{name};
}

/// Description of the content of a file that is no rawlog.
std::string describe(const std::string& bytes) {
  const bool text = std::all_of(bytes.begin(), bytes.end(), [](char c) {
    const auto u = static_cast<unsigned char>(c);
    return (u >= 0x20 && u != 0x7f) || u == '\n' || u == '\r' || u == '\t';
  });
  if (text) {
    std::string line = bytes.substr(0, bytes.find_first_of("\r\n"));
    if (line.size() > 40) line = line.substr(0, 40) + "...";
    return fmt::format("text that begins with \"{}\"", line);
  }
  std::string hex;
  for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 8); ++i) {
    hex += fmt::format(" {:02x}", static_cast<unsigned char>(bytes[i]));
  }
  return "data that begins with" + hex;
}

/// The relevant line of an MRPT exception, whose text includes source positions and a call stack.
std::string firstLine(const std::string& text) {
  const std::string marker = "Message:";
  const auto last = text.rfind(marker);
  std::string line = last == std::string::npos ? text : text.substr(last + marker.size());
  line.erase(0, line.find_first_not_of(" \t\r\n"));
  line = line.substr(0, line.find_first_of("\r\n"));
  return line.size() > 200 ? line.substr(0, 200) + "..." : line;
}

std::string unknownClassMessage(const std::string& name) {
  return fmt::format(
      "entry of the unknown class '{}': link or load the library that registers it (plugin)", name);
}

/// What is known about entries of a class that cannot be read, as the end of a message.
std::string knownCause(const std::string& class_name) {
  if (class_name.find("CObservationRotatingScan") == std::string::npos) return "";
  return "; MRPT 2.14 stores one byte more of this class than MRPT 2.5 without a new version "
         "number:"
         " read the log with the version of MRPT that wrote it";
}

/// The class named in MRPT's "Stored object has class 'X' which is not registered!" (inside a
/// sensory frame).
std::string unknownClassIn(const std::string& text) {
  if (text.find("is not registered") == std::string::npos) return "";
  const auto begin = text.find("has class '");
  if (begin == std::string::npos) return "";
  const auto name = begin + 11;
  return text.substr(name, text.find('\'', name) - name);
}

}  // namespace

std::string RawlogReader::endName() const { return nameOf(end_); }

const char* nameOf(RawlogReader::End end) {
  static constexpr const char* kNames[] = {"not_yet",       "clean",         "torn",
                                           "unknown_class", "newer_version", "damaged"};
  return kNames[static_cast<std::size_t>(end)];
}

RawlogReader::RawlogReader(const std::string& path, FileSink sink) : path_(path) {
  registerPerceptionClasses();
  linkCheckedAllocation();
  linkJpegErrors();
  input_ = std::make_unique<CRawlogInput>(path, std::move(sink));
  const std::string begin = input_->peek(kHeaderBytes);
  if (input_->state() == CRawlogInput::State::kFailed) {
    throw DataError(fmt::format("{}: {}", path, input_->reason()));
  }
  if (begin.empty() && input_->state() == CRawlogInput::State::kEnd) {
    throw DataError(
        fmt::format("{}: a {} container without a single entry in it", path, input_->container()));
  }
  bool complete = false;
  if (!begin.empty() && !parseHeader(begin, complete)) {
    const std::string container = input_->container();
    throw DataError(
        fmt::format("{}: not a rawlog but {}{}", path, describe(begin),
                    container.empty() ? "" : fmt::format(" inside a {} container", container)));
  }
}

RawlogReader::~RawlogReader() = default;

bool RawlogReader::verifiable() const { return input_->compressed() && input_->members() == 1; }
std::uint64_t RawlogReader::bytesRead() const { return input_->fileBytesRead(); }
std::uint64_t RawlogReader::fileBytes() const { return input_->fileBytes(); }

std::shared_ptr<mrpt::obs::CObservation> RawlogReader::next() {
  while (ready_.empty() && end_ == End::kNotYet && readEntry()) {
  }
  if (ready_.empty()) return nullptr;
  auto observation = std::move(ready_.front());
  ready_.pop_front();
  if (const auto stamp = toStamp(observation->timestamp)) last_stamp_ = stamp;
  return observation;
}

void RawlogReader::finish(End end, const std::string& what) {
  end_ = end;
  if (end == End::kClean) {
    end_message_ = fmt::format("{}: whole, {} entries", path_, entries_);
    return;
  }
  // Observations of earlier entries may still be in ready_: their stamps are the last ones of the
  // log.
  for (const auto& observation : ready_) {
    if (const auto stamp = toStamp(observation->timestamp)) last_stamp_ = stamp;
  }
  end_message_ = fmt::format("{}: {}; entry {} at byte {}{}, after {} whole entries, last stamp {}",
                             path_, what, entries_, entry_offset_,
                             input_->compressed() ? " of the inflated data" : "", entries_,
                             last_stamp_ ? fmt::format("{:.6f}", last_stamp_->seconds()) : "none");
}

/// Sets end() by the exception of an entry's class.
void RawlogReader::finishAtFault(const std::string& class_name, const std::string& fault) {
  using State = CRawlogInput::State;
  const std::string unknown = unknownClassIn(fault);
  if (input_->state() == State::kTorn) {
    finish(End::kTorn, input_->reason() + knownCause(class_name));
  } else if (input_->state() != State::kGood && input_->state() != State::kEnd) {
    finish(End::kDamaged, input_->reason());
  } else if (!unknown.empty()) {
    finish(End::kUnknownClass, unknownClassMessage(unknown));
  } else if (fault.find("unknown serialization version") != std::string::npos) {
    finish(End::kNewerVersion,
           fmt::format("entry of class '{}' was written by a newer version of it: {}", class_name,
                       firstLine(fault)));
  } else {
    finish(End::kDamaged, fmt::format("entry of class '{}' cannot be read: {}{}", class_name,
                                      firstLine(fault), knownCause(class_name)));
  }
}

bool RawlogReader::readEntry() {
  using State = CRawlogInput::State;
  entry_offset_ = input_->position();
  if (input_->atEnd()) {
    const State state = input_->state();
    finish(state == State::kEnd    ? End::kClean
           : state == State::kTorn ? End::kTorn
                                   : End::kDamaged,
           input_->reason());
    return false;
  }
  bool complete = false;
  const auto header = parseHeader(input_->peek(kHeaderBytes), complete);
  if (!header) {
    finish(End::kDamaged, "bytes that are no header of an entry");
    return false;
  }
  if (complete && header->class_name != "nullptr" &&
      mrpt::rtti::findRegisteredClass(header->class_name) == nullptr) {
    finish(End::kUnknownClass, unknownClassMessage(header->class_name));
    return false;
  }
  mrpt::serialization::CSerializable::Ptr object;
  try {
    const ReadingScope scope(path_, entry_offset_);
    const MemoryLimit limit(addressSpace() + (kLargestEntry << 20));
    object = input_->ReadObject();
  } catch (const std::bad_alloc&) {
    finish(End::kDamaged,
           fmt::format("entry of class '{}' needs more than {} MiB of memory{}", header->class_name,
                       kLargestEntry, knownCause(header->class_name)));
    return false;
  } catch (const std::exception& e) {
    finishAtFault(header->class_name, e.what());
    return false;
  }
  ++entries_;
  take(object);
  return true;
}

void RawlogReader::take(const mrpt::serialization::CSerializable::Ptr& object) {
  if (!object) {
    ++skipped_["nullptr"];
  } else if (auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object)) {
    give(std::move(observation));
  } else if (const auto* frame = dynamic_cast<const mrpt::obs::CSensoryFrame*>(object.get())) {
    for (const auto& inside : *frame) {
      if (inside) give(inside);
    }
  } else if (const auto* actions =
                 dynamic_cast<const mrpt::obs::CActionCollection*>(object.get())) {
    addActions(*actions);
  } else {
    ++skipped_[object->GetRuntimeClass()->className];
  }
}

/// A sensor without a label gets the name of its class, so that an INI can name it.
void RawlogReader::give(mrpt::obs::CObservation::Ptr observation) {
  if (observation->sensorLabel.empty() && isSensorData(*observation)) {
    const std::string name = observation->GetRuntimeClass()->className;
    observation->sensorLabel = name.substr(name.rfind(':') + 1);
  }
  ready_.push_back(std::move(observation));
}

void RawlogReader::addActions(const mrpt::obs::CActionCollection& actions) {
  for (const auto& action : actions) {
    const auto* movement = dynamic_cast<const mrpt::obs::CActionRobotMovement2D*>(action.get());
    if (movement == nullptr ||
        movement->estimationMethod != mrpt::obs::CActionRobotMovement2D::emOdometry) {
      ++skipped_[action->GetRuntimeClass()->className];
      continue;
    }
    odometry_ = odometry_ + movement->rawOdometryIncrementReading;
    auto observation = std::make_shared<mrpt::obs::CObservationOdometry>();
    observation->timestamp = movement->timestamp;
    observation->sensorLabel = "ODOMETRY";
    observation->odometry = odometry_;
    observation->hasVelocities = movement->hasVelocities;
    observation->velocityLocal = movement->velocityLocal;
    ready_.push_back(std::move(observation));
  }
}

}  // namespace perception
