// SPDX-License-Identifier: Apache-2.0
// The memory that all arrays of one file may take together.
#pragma once
#include <cstdint>
#include <string>

#include "data/memory/memory_budget.h"

namespace sg {

/// While it lives, the arrays that this thread allocates are those of the file (or folder) at `path`. More of them than
/// plausible_memory() of the files that were mapped meanwhile give Error(data) naming `path`, before memory is allocated: whatever
/// the reader, and however often one small part of the file is named. A reading inside counts for itself.
class ReadingBudget final : public detail::ClaimWatch {
 public:
  /// `names_others`: the numbers may be in files that are opened later; those next to `path` count too.
  ReadingBudget(std::string path, bool names_others);
  void on_claim(size_t bytes) override;

 private:
  std::string path_;
  bool names_others_;
  uint64_t mapped_before_, used_ = 0, beside_ = 0;
};

}  // namespace sg
