#include "libperception/scene/files/EventLog.h"

#include <algorithm>
#include <utility>

#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

using Json = nlohmann::ordered_json;

// One line. Text that is not UTF-8 (a sensor label of a damaged log) must not end the run: it is
// replaced.
std::string jsonLine(const Json& event) {
  return event.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

void EventLog::add(std::optional<Stamp> stamp, const std::string& kind, const std::string& message,
                   Fields fields, Severity severity) {
  if (severity == Severity::kWarning) {
    ++warnings_;
    if (first_warnings_.size() < kFirst &&
        std::find(first_warnings_.begin(), first_warnings_.end(), message) == first_warnings_.end())
      first_warnings_.push_back(message);
  }
  ++counts_[kind];
  if (fields.is_null()) fields = Fields::object();
  Event event{stamp, kind, message, std::move(fields), severity};
  held_.empty() || lets_through_ ? put(std::move(event)) : held_.back().push_back(std::move(event));
}

void EventLog::put(Event event) {
  if (listener_) listener_(event.stamp, contentOf(event));
  if (file_) {
    file_->write(lineOf(event, first_stamp_));
  } else if (++stored_[event.kind] <= kept_per_kind_) {
    events_.push_back(std::move(event));
  }
}

void EventLog::release(const std::function<void()>& late) {
  lets_through_ = true;
  late();
  lets_through_ = false;
  if (held_.empty()) return;
  for (Event& event : held_.front()) put(std::move(event));
  held_.pop_front();
}

void EventLog::warn(std::optional<Stamp> stamp, const std::string& kind, const std::string& message,
                    Fields fields) {
  add(stamp, kind, message, std::move(fields), Severity::kWarning);
}

Json EventLog::contentOf(const Event& event) {
  return {{"kind", event.kind},
          {"severity", event.severity == Severity::kWarning ? "warning" : "info"},
          {"message", event.message},
          {"fields", event.fields}};
}

std::string EventLog::lineOf(const Event& event, Stamp first_stamp) {
  Json line;
  // Divided, not multiplied by 1e-9: the nearest double, which prints as the short number that it
  // is.
  line["t"] =
      event.stamp ? Json(static_cast<double>(event.stamp->ns - first_stamp.ns) / 1e9) : Json();
  line["stamp"] = event.stamp ? Json(decimalSeconds(event.stamp->ns)) : Json();
  line.update(contentOf(event));
  return jsonLine(line);
}

std::string EventLog::text(Stamp first_stamp) const {
  std::string lines;
  for (const Event& event : events_) lines += lineOf(event, first_stamp);
  for (const auto& [kind, count] : counts_) {
    if (count <= kept_per_kind_) continue;
    lines += jsonLine({{"t", nullptr},
                       {"stamp", nullptr},
                       {"kind", "events_not_written"},
                       {"severity", "info"},
                       {"message", "more events of this kind were counted only"},
                       {"fields", {{"kind", kind}, {"events", count - kept_per_kind_}}}});
  }
  return lines;
}

void EventLog::writeTo(const std::string& path, Stamp first_stamp) {
  file_.emplace(path);
  file_->write(text(first_stamp));
  first_stamp_ = first_stamp;
  events_ = {};
}

void EventLog::close() { file_->close(); }

}  // namespace perception
