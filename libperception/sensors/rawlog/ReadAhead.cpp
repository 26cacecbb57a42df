#include "libperception/sensors/rawlog/ReadAhead.h"

#include <system_error>
#include <utility>

namespace perception {

ReadAhead::ReadAhead(std::unique_ptr<ObservationInput> input)
    : input_(std::move(input)), file_bytes_(input_->fileBytes()) {
  try {
    reader_ = std::thread([this] { readAll(); });
  } catch (const std::system_error&) {
    return;
  }
}

ReadAhead::~ReadAhead() {
  if (!reader_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  changed_.notify_all();
  reader_.join();
}

std::shared_ptr<mrpt::obs::CObservation> ReadAhead::next() {
  if (ended_) return nullptr;
  if (reader_.joinable()) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !ahead_.empty(); });
    at_ = std::move(ahead_.front());
    ahead_.pop_front();
    lock.unlock();
    changed_.notify_all();
  } else {
    at_ = take();
  }
  ended_ = !at_.observation;
  if (at_.fault) std::rethrow_exception(at_.fault);
  return std::move(at_.observation);
}

ReadAhead::Taken ReadAhead::take() {
  Taken taken;
  try {
    taken.observation = input_->next();
  } catch (...) {
    taken.fault = std::current_exception();
  }
  taken.complete = input_->isComplete(), taken.verifiable = input_->verifiable();
  taken.end_name = input_->endName(), taken.end_message = input_->endMessage();
  taken.entries = input_->entries(), taken.bytes_read = input_->bytesRead();
  taken.last_stamp = input_->lastStamp();
  return taken;
}

void ReadAhead::readAll() {
  for (bool last = false; !last;) {
    Taken taken = take();
    last = !taken.observation;
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return stop_ || ahead_.size() < kAhead; });
    if (stop_) return;
    ahead_.push_back(std::move(taken));
    lock.unlock();
    changed_.notify_all();
  }
}

}  // namespace perception
