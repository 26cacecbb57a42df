#pragma once
#include "libperception/core/Time.h"

namespace perception::test {

/// 2020-01-01 00:00 UTC: when the made-up logs of tests begin.
inline constexpr Stamp kStart{1'577'836'800'000'000'000};

}  // namespace perception::test
