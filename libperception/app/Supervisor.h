#pragma once
#include "libperception/core/system/SupervisedChild.h"

namespace perception {

class App;

/// runApp() in a process of its own, watched by this one: whatever libraries do on bad data, the
/// program ends with a message and a code of ExitCode, and nothing temporary is left. A child that
/// crashes, that a library ends, or that does not get on while it reads data of others
/// (ReadingScope): kBadInput with file and position; elsewhere: kInternal. SIGTERM and SIGINT are
/// passed on; a child that does not end is killed: kTryAgain, as for one that is killed from
/// outside (SIGKILL), which says nothing of its data.
int runSupervised(App& app, int argc, const char* const* argv, SupervisorLimits limits = {});

}  // namespace perception
