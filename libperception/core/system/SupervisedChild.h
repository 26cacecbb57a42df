#pragma once
#include <sys/types.h>

#include <csignal>
#include <string>

#include "libperception/core/system/Supervision.h"

namespace perception {

struct SupervisorLimits {
  double reading = 20;  ///< [s] of processor time for one entry of data of others; assumed
  double stop = 4.5;    ///< [s] from a signal to the end
};

/// Signals that a supervisor takes; they are blocked before superviseChild().
sigset_t supervisedSignals();

/// Waits for the end of the child `process`, which writes `record`. Passes SIGTERM and SIGINT on,
/// kills a child that hangs or does not stop, removes its temporaries. The exit code of the
/// program, whose name stands in a message of what went wrong.
int superviseChild(pid_t process, SupervisionRecord& record, const std::string& program,
                   SupervisorLimits limits);

}  // namespace perception
