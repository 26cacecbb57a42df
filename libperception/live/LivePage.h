#pragma once
#include <string>

namespace perception {

/// The page of a run that goes on: the one of perception-report, fed over a WebSocket. "{NONCE}"
/// stands for that of its script (LiveServer::Params::page).
std::string livePage(const std::string& log);

}  // namespace perception
