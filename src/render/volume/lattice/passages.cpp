// SPDX-License-Identifier: Apache-2.0
#include "render/volume/lattice/passages.h"

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

Passages::Passages(const Bends& bends, const Distances* empty) : range(bends.range) {
  const size_t n = bends.codes.size();
  if (empty && empty->size() != n) fail_internal("passages: bends and distances of the same bricks were expected");
  codes.resize(n);
  const uint8_t *bend = bends.codes.data(), *distance = empty ? empty->data() : nullptr;
  uint8_t* to = codes.data();
  parallel_for(n, 1 << 18, [=](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) to[i] = std::max(bend[i], drawn);
    for (size_t i = begin; distance && i < end; ++i) to[i] = distance[i] > 0 ? distance[i] : to[i];
  });
}

}  // namespace sg::volume
