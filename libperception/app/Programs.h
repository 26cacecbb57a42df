#pragma once

#include <memory>

#include "libperception/app/App.h"

namespace perception {

/// The programs' classes for their main() functions, which need not know how they look.
std::unique_ptr<App> batchApp();
std::unique_ptr<App> calibrateApp();
std::unique_ptr<App> detectApp();
std::unique_ptr<App> doctorApp();
std::unique_ptr<App> evaluateApp();
std::unique_ptr<App> exportApp();
std::unique_ptr<App> grabberApp();
std::unique_ptr<App> importApp();
std::unique_ptr<App> reportApp();
std::unique_ptr<App> reviewApp();
std::unique_ptr<App> simulateApp();
std::unique_ptr<App> snapshotApp();
std::unique_ptr<App> studyApp();
std::unique_ptr<App> trackApp();

}  // namespace perception
