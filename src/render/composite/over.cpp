// SPDX-License-Identifier: Apache-2.0
#include "render/composite/over.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/parallel.h"

namespace sg {

void check_fragments(const FragmentLists& fragments, const Frame& frame) {
  if (fragments.empty()) return;
  if (fragments.start.size() != frame.pixels() + 1 || fragments.start.back() != fragments.fragments.size())
    fail_internal(fmt::format("the fragment lists do not belong to a frame of {} x {}", frame.width, frame.height));
}

void composite_fragments(const FragmentLists& fragments, Frame& frame, const Context& context) {
  check_fragments(fragments, frame);
  if (fragments.empty()) return;
  parallel_for(
      frame.pixels(), 4096,
      [&](size_t begin, size_t end) {
        for (size_t p = begin; p < end; ++p) {
          if (fragments.start[p] == fragments.start[p + 1]) continue;
          Gathered sum;
          for (uint32_t f = fragments.start[p]; f < fragments.start[p + 1]; ++f) sum.behind(fragments.fragments[f].rgba);
          float* out = &frame.rgba[4 * p];
          sum.behind(out);
          out[0] = sum.r, out[1] = sum.g, out[2] = sum.b, out[3] = 1 - sum.transmittance;
        }
      },
      &context);
}

}  // namespace sg
