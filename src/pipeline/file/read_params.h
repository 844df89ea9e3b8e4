// SPDX-License-Identifier: Apache-2.0
// The parameters of a step that reads a file, declared like those of an operation.
#pragma once
#include "base/schema/schema.h"
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
  std::optional<double> time;
  int64_t step = -1;
  std::string csv_header = "auto";
  std::string times;
  std::vector<int64_t> region, stride;
  int piece = 0, pieces = 1, ghost_levels = 0;
};
void describe(Schema& s, ReadParams& p);

/// Throws Error(usage) when path is missing, or lists do not have their length.
ReadOptions read_options(const ReadParams& params);
/// The other way round: the words that say the same.
std::vector<std::string> read_words(const std::string& path, const ReadOptions& options);

}  // namespace sg
