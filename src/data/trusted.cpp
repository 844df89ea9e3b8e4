// SPDX-License-Identifier: Apache-2.0
#include "data/trusted.h"

namespace sg {

namespace {
thread_local bool trusted = false;
}

bool detail::mesh_is_trusted() { return trusted; }

DatasetPtr make_trusted_dataset(DatasetParts parts) {
#ifndef NDEBUG
  return make_dataset(std::move(parts));
#else
  struct Scope {
    Scope() { trusted = true; }
    ~Scope() { trusted = false; }
  } scope;
  return make_dataset(std::move(parts));
#endif
}

}  // namespace sg
