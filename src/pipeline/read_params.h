// SPDX-License-Identifier: Apache-2.0
// The parameters of a step that reads a file, declared like those of an operation.
#pragma once
#include "base/schema.h"
#include "io/io.h"

namespace sg {

struct ReadParams {
  std::string path;
  std::vector<std::string> fields;
  std::vector<int64_t> dims;
  std::string type;
  bool big_endian = false;
  int64_t header = 0;
  int components = 1;
  Vec3 spacing{1, 1, 1};
};
void describe(Schema& s, ReadParams& p);

/// Throws Error(usage) when path is missing or dims are not three.
ReadOptions read_options(const ReadParams& params);

}  // namespace sg
