// SPDX-License-Identifier: Apache-2.0
// Numbered files in a folder as what they are: steps of one series.
#pragma once
#include <string>
#include <vector>

#include "serve/guard/confined_path.h"

namespace sg::serve {

struct ListedFile {
  std::string name;   ///< "flow_{n}.vtk" for a series (io/file_series.h)
  size_t bytes = 0;   ///< of all of them
  size_t series = 1;  ///< how many files
};

/// Three files or more whose names differ only in their last whole number are one series, at the place of the first. `files` are in natural
/// order. Names with signs that mean something in names of series stay alone.
std::vector<ListedFile> grouped_as_series(const std::vector<ConfinedFolder::Entry>& files);
/// Whether a name stands for a series as grouped_as_series() writes them; then what stands in front of the number and behind it.
bool split_series_name(const std::string& name, std::string& front, std::string& behind);
/// Whether a text has signs that mean something in names of series.
bool has_series_signs(const std::string& text);

}  // namespace sg::serve
