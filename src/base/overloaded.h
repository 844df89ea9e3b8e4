// SPDX-License-Identifier: Apache-2.0
// One function object out of several, for std::visit.
#pragma once

namespace sg {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};

}  // namespace sg
