// SPDX-License-Identifier: Apache-2.0
// A folder of parts beside the file that names them, written so that nothing half is left.
#pragma once
#include <string>

namespace sg::vtk {

/// For "a/x.vtm" the folder is "a/x" and its files are "x_0.vtu", ... Parts are written to a folder of another name, which
/// commit() renames; without commit it is removed. A folder of that name from an earlier time is replaced when it holds only such
/// parts; else the constructor throws Error(usage).
class PartsFolder {
 public:
  explicit PartsFolder(const std::string& path);
  ~PartsFolder();
  PartsFolder(const PartsFolder&) = delete;
  PartsFolder& operator=(const PartsFolder&) = delete;

  /// Where to write part i for now, and how the file names it.
  std::string file(size_t i, std::string_view extension) const;
  std::string name(size_t i, std::string_view extension) const;
  void commit();

 private:
  std::string stem_, folder_, partial_, old_;
  bool done_ = false;
};

}  // namespace sg::vtk
