// SPDX-License-Identifier: Apache-2.0
#include "render/volume/engines/packets/passages.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"

namespace sg::volume {

Passages::Passages(std::shared_ptr<const Bends> of) : codes(of->codes), bends(std::move(of)) {
  for (uint8_t& code : codes) code = std::max(code, drawn);
}

Passages::Passages(std::shared_ptr<const Bends> of, SpaceAhead empty) : codes(std::move(empty.bricks)), up(empty.up), bends(std::move(of)) {
  constexpr size_t after = 3;
  const size_t n = bends->codes.size() - after;
  if (codes.size() != empty.octants * n + after) fail_internal("passages: bends and empty space of the same bricks were expected");
  for (size_t o = 0; o < empty.octants; ++o)
    parallel_for(n, 1 << 18, [&](size_t begin, size_t end) {
      const uint8_t* bend = bends->codes.data();
      uint8_t* own = &codes[o * n];
      for (size_t i = begin; i < end; ++i) own[i] = own[i] > 0 ? own[i] : std::max(bend[i], drawn);
    });
}

}  // namespace sg::volume
