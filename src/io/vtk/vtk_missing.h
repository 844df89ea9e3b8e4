// SPDX-License-Identifier: Apache-2.0
// Files that another one names and that are not there, as after a copy of a part or a run that was stopped.
#pragma once
#include <string>
#include <vector>

#include "base/context.h"

namespace sg::vtk {

/// What was named and not found: the rest is read, with one warning.
class MissingFiles {
 public:
  /// Is there no such file? Then it counts as missing. Throws Error(data) outside of the fence (file_fence.h).
  bool lacks(const std::string& path);
  /// Counts one that is there.
  void found() { ++found_; }
  /// Warns of the missing ones; throws Error(data) where nothing else was found. `path`: the file that names them.
  void tell(const std::string& path, Context& context) const;

 private:
  std::vector<std::string> missing_;
  size_t found_ = 0;
};

}  // namespace sg::vtk
