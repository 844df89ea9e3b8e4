// SPDX-License-Identifier: Apache-2.0
// Pictures at several times as the content of a page, within a budget.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "pipeline/offline/pack/arrays.h"
#include "pipeline/offline/pack/quality.h"
#include "pipeline/picture/picture_parts.h"

namespace sg::offline {

struct PageStep {
  std::optional<double> time;
  Panel panel;
  StatedPicture stated;
};

struct PackedPage {
  std::string description;  ///< JSON: everything but the numbers of `arrays`
  ArrayStore arrays;        ///< compressed
  std::vector<std::string> notes;
  size_t bytes() const { return description.size() + arrays.text_bytes(); }
};

/// All steps at one quality. What has no more than `small` bytes stays as fine as it is.
PackedPage pack_page(const std::vector<const PageStep*>& steps, const Quality& quality, size_t small, Context& context);

/// The finest page of at most `budget` bytes; the notes say what is coarser, and how many of the steps there are. Throws Error(usage) where
/// not even the coarsest has room, with the bytes that it takes.
PackedPage pack_within(const std::vector<PageStep>& steps, size_t budget, Context& context);

}  // namespace sg::offline
