// SPDX-License-Identifier: Apache-2.0
// Runs the sightglass program as a user would.
#pragma once
#include <string>
#include <vector>

namespace sg::test {

struct Ran {
  int status = -1;  ///< exit code; 128 + signal when it was killed
  std::string out, err;
  size_t peak_bytes = 0;  ///< most memory it held at a time, mapped files included
};
/// Runs `sightglass ARGS...` in `folder` (default: the temporary folder).
/// `largest_file` > 0 limits the size of files it can write, as a full disk does.
Ran sightglass(const std::vector<std::string>& args, const std::string& folder = {}, long largest_file = 0);

/// Runs it in the temporary folder; the test stops where it fails.
Ran must(const std::vector<std::string>& args);

/// The bytes of a file in the temporary folder.
std::string bytes_of(const std::string& name);

/// Names of the files in a folder, sorted.
std::vector<std::string> files_in(const std::string& folder);

}  // namespace sg::test
