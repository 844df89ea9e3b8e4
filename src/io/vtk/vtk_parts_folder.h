// SPDX-License-Identifier: Apache-2.0
// A folder of parts next to the file that names them, written so that nothing incomplete is left.
#pragma once
#include <optional>
#include <string>

#include "io/atomic_files.h"

namespace sg::vtk {

/// For "a/x.vtm" the folder is "a/x" and its files are "x_0.vtu", ... Parts are written to a folder of another name. commit() flushes the
/// text of the file itself to disk, then moves the folder and after it the file into place; when anything fails, folder and file of an
/// earlier time stay, both. Without commit nothing is left. A folder of that name is replaced when it holds only such parts; else the
/// constructor throws Error(usage).
class PartsFolder {
 public:
  explicit PartsFolder(const std::string& path);
  ~PartsFolder();
  PartsFolder(const PartsFolder&) = delete;
  PartsFolder& operator=(const PartsFolder&) = delete;

  /// Temporary path for writing part i, and its name in the file.
  std::string file(size_t i, std::string_view extension) const;
  std::string name(size_t i, std::string_view extension) const;
  void commit(std::string_view text);

 private:
  std::string stem_, folder_, partial_, old_;
  std::optional<AtomicFiles> header_;
  bool done_ = false;
};

}  // namespace sg::vtk
