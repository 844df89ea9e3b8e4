// SPDX-License-Identifier: Apache-2.0
#include "io/vtk/vtk_missing.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"

namespace sg::vtk {

bool MissingFiles::lacks(const std::string& path) {
  check_may_read(path);
  if (file_exists(path)) return false;
  missing_.push_back(path);
  return true;
}

void MissingFiles::tell(const std::string& path, Context& context) const {
  if (missing_.empty()) return;
  if (found_ == 0) fail_data("no such file", missing_[0], fmt::format("'{}' names it, and nothing that is there", path));
  context.warn(fmt::format("{}: {} of the {} files that it names {} missing ({}{}); the rest is read", path, missing_.size(),
                           missing_.size() + found_, missing_.size() == 1 ? "is" : "are", missing_[0], missing_.size() > 1 ? ", ..." : ""));
}

}  // namespace sg::vtk
