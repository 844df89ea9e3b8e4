// SPDX-License-Identifier: Apache-2.0
// A file for readers that do not look into it.
#pragma once
#include "base/file/file.h"
#include "support/test.h"

namespace sg::test {

/// Its path in the temporary folder.
inline std::string some_file(const std::string& name = "graph.raw") {
  const std::string path = temp_folder() + name;
  if (!file_exists(path)) write_file(path, std::string(4000, 'x'));
  return path;
}

}  // namespace sg::test
