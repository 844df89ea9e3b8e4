// SPDX-License-Identifier: Apache-2.0
// Whether a run that was broken off goes on from its stored state to the bytes of an unbroken one.
#pragma once
#include <string>

#include "simulate/run/frames.h"
#include "support/test.h"

namespace sg::test {

inline std::string fields_of(const DatasetPtr& d) {
  std::string out;
  for (const Field& f : d->fields()) {
    out += f.name;
    for (size_t i = 0; i < f.array.count(); ++i)
      for (int c = 0; c < f.components(); ++c) {
        const double v = f.array.get(i, c);
        out.append(reinterpret_cast<const char*>(&v), sizeof v);
      }
  }
  return out;
}

/// `run` shows a frame of the parameters; the run of `other` ones takes the place of what is kept in memory. Returns the path of the state.
template <class Params, class Run>
std::string goes_on(const std::string& name, Params p, Params other, Run&& run) {
  INFO(name);
  const auto afresh = [&](const Params& q) {
    run(other);
    return fields_of(run(q));
  };
  p.time = 7 * p.frame;
  const std::string unbroken = afresh(p);
  Params stored = p;
  stored.store = fresh_folder("stored_" + name) + "run", stored.time = 4 * p.frame;
  const std::string before = afresh(stored);
  CHECK(before != unbroken);
  CHECK(StateFile(stored.store).frame() == 4);
  stored.time = p.time;
  CHECK(afresh(stored) == unbroken);
  CHECK(StateFile(stored.store).frame() == 7);
  return stored.store;
}

}  // namespace sg::test
