// SPDX-License-Identifier: Apache-2.0
// Beside which others a question is answered.
#pragma once
#include <array>

#include "serve/renderer/wish.h"

namespace sg::serve {

/// Questions of one lane do not wait for those of others: nobody's look at a place waits for statistics, nor these for a picture that is
/// saved.
enum class Lane {
  quick,    ///< looks at a place, a line or some rows
  lengthy,  ///< looks at all the data
  save,     ///< draws a picture to keep
};

inline Lane lane_of(Wish w) {
  if (w == Wish::save) return Lane::save;
  return w == Wish::probe || w == Wish::rows || w == Wish::line ? Lane::quick : Lane::lengthy;
}

/// The lane of each thread that answers: two lengthy questions, of different windows, are answered beside each other.
inline constexpr std::array answering = {Lane::quick, Lane::lengthy, Lane::lengthy, Lane::save};

}  // namespace sg::serve
