// SPDX-License-Identifier: Apache-2.0
#include "data/trusted.h"

namespace sg {

namespace {
thread_local bool trusted = false;
}

bool detail::mesh_is_trusted() { return trusted; }

DatasetPtr make_trusted_dataset(DatasetParts parts, std::shared_ptr<const BrickedVolume> bricks) {
#ifndef NDEBUG
  return make_dataset(std::move(parts), std::move(bricks));
#else
  struct Scope {
    Scope() { trusted = true; }
    ~Scope() { trusted = false; }
  } scope;
  return make_dataset(std::move(parts), std::move(bricks));
#endif
}

}  // namespace sg
