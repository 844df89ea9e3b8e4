// SPDX-License-Identifier: Apache-2.0
#include "simulate/run/given_data.h"

#include <fmt/core.h>

#include "data/content_hash.h"

namespace sg {

std::string GivenData::objects() const {
  std::string text;
  for (const Part& p : parts_) text += fmt::format("{}{} ", p.as, static_cast<const void*>(p.data.get()));
  return text;
}

std::string GivenData::content() const {
  std::string text;
  for (const Part& p : parts_) text += fmt::format("{}{} ", p.as, content_hash(*p.data, p.fields));
  return text;
}

}  // namespace sg
