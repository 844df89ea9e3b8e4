// SPDX-License-Identifier: Apache-2.0
#include "io/reading_budget.h"

#include <algorithm>
#include <filesystem>

#include "base/file/file.h"
#include "base/file/mapped_watch.h"
#include "io/plausible.h"

namespace sg {

namespace {

constexpr int most_entries = 200000;

// Bytes of the files in a folder and below.
uint64_t bytes_below(const std::string& folder) {
  namespace fs = std::filesystem;
  uint64_t sum = 0;
  int n = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator at(folder.empty() ? "." : folder, fs::directory_options::skip_permission_denied, error), end;
       !error && at != end && n < most_entries; at.increment(error), ++n) {
    std::error_code none;
    if (at->is_regular_file(none))
      if (const uint64_t bytes = at->file_size(none); !none) sum += bytes;
  }
  return sum;
}

}  // namespace

ReadingBudget::ReadingBudget(std::string path, bool names_others)
    : path_(std::move(path)), names_others_(names_others), mapped_before_(mapped_watch().bytes_ever()) {}

void ReadingBudget::on_claim(size_t bytes) {
  const uint64_t files = mapped_watch().bytes_ever() - mapped_before_;
  if (__builtin_add_overflow(used_, bytes, &used_)) used_ = UINT64_MAX;
  if (used_ <= plausible_memory(std::max(files, beside_))) return;
  if (names_others_ && beside_ == 0) beside_ = bytes_below(is_folder(path_) ? path_ : folder_of(path_));
  check_plausible(used_, std::max(files, beside_), path_);
}

}  // namespace sg
