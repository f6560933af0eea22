#pragma once
#include <functional>

#include "export/pipeline/control.h"

namespace quadsonde::cli {

/// Runs work on a thread of its own and watches for Ctrl-C (SIGINT) and SIGTERM meanwhile. After one the work is asked
/// to stop and waited for as long as it writes, else for half a second; then the process ends with 130.
/// @param progress  what the work's Control reports to
/// @return what the work returns
int run_interruptible(const std::function<int(const product::Control&)>& work,
                      std::function<void(std::string_view, double)> progress);

}  // namespace quadsonde::cli
