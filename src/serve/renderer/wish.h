// SPDX-License-Identifier: Apache-2.0
// What a window may say ("do" in docs/protocol.md).
#pragma once
#include <array>
#include <optional>
#include <string>

#include "base/schema/enum_words.h"
#include "base/text/json.h"

namespace sg::serve {

enum class Wish {
  draw,
  shown,
  cursor,
  together,
  // changes of the pipeline
  edit,
  undo,
  redo,
  pipeline,
  time,
  // questions
  probe,
  rows,
  line,
  measures,
  over_time,
  histogram,
  plane,
  proposals,
  save,
};
constexpr auto enum_words(Wish) {
  using enum Wish;
  return std::array{Word{"draw", draw},         Word{"shown", shown},         Word{"cursor", cursor},
                    Word{"together", together}, Word{"edit", edit},           Word{"undo", undo},
                    Word{"redo", redo},         Word{"pipeline", pipeline},   Word{"time", time},
                    Word{"probe", probe},       Word{"rows", rows},           Word{"line", line},
                    Word{"measures", measures}, Word{"over_time", over_time}, Word{"histogram", histogram},
                    Word{"plane", plane},       Word{"proposals", proposals}, Word{"save", save}};
}
inline bool changes(Wish w) { return w >= Wish::edit && w <= Wish::time; }
inline bool asks(Wish w) { return w >= Wish::probe; }

/// Nothing for other words.
inline std::optional<Wish> wish_of(const Json& message) { return value_of_word<Wish>(message["do"].text()); }

}  // namespace sg::serve
