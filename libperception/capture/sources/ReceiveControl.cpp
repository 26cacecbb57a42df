#include "libperception/capture/sources/ReceiveControl.h"

#include <time.h>

#include <cstring>

namespace perception {

void ReceiveControl::request(int socket) {
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_RXQ_OVFL, &on, sizeof on);
  ::setsockopt(socket, SOL_SOCKET, SO_TIMESTAMPNS, &on, sizeof on);
}

Stamp ReceiveControl::read(const msghdr& message) {
  timespec time{};
  ::clock_gettime(CLOCK_REALTIME, &time);
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr;
       c = CMSG_NXTHDR(const_cast<msghdr*>(&message), c)) {
    if (c->cmsg_level != SOL_SOCKET) continue;
    if (c->cmsg_type == SO_TIMESTAMPNS) std::memcpy(&time, CMSG_DATA(c), sizeof time);
    if (c->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t lost = 0;  // since the socket was opened, modulo 2^32
    std::memcpy(&lost, CMSG_DATA(c), sizeof lost);
    overrun_ += lost - static_cast<std::uint32_t>(overrun_);
  }
  return {(static_cast<std::int64_t>(time.tv_sec) * 1000000000 + time.tv_nsec) / 100 * 100};
}

}  // namespace perception
