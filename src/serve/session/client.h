// SPDX-License-Identifier: Apache-2.0
// One window at a session, and its views.
#pragma once
#include <array>
#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "serve/guard/rights.h"
#include "serve/http/server.h"
#include "serve/renderer/renderer.h"

namespace sg::serve {

/// What a window wants to see in one of its views, and how far that has come.
struct WantedView {
  DrawRequest request;              ///< view: of the renderer, unlike all others
  uint64_t n = 0;                   ///< of the newest request
  uint64_t base = 0;                ///< revision of the whole picture of this size that the window shows; 0: none
  uint64_t whole = 0;               ///< revision of the last whole picture that was sent, ...
  std::array<int, 4> whole_area{};  ///< ... and where in it the camera looks
  bool moving = false;
  bool due = false;  ///< something better than what was sent is to be drawn
  Quality next = Quality::moving;
  bool on_its_way = false;  ///< a frame was sent that the window has not shown
  std::chrono::steady_clock::time_point served;
  std::chrono::steady_clock::time_point waits_since;  ///< of a better picture than the first one
  bool gave_way = false;                              ///< and was interrupted since then by what moved

  /// Everything anew: for another camera, size or pipeline.
  void restart() { due = true, gave_way = false, next = Quality::moving; }
  /// A better picture could be drawn from now on.
  void wait() {
    if (!gave_way) waits_since = std::chrono::steady_clock::now();
  }
};

struct Client {
  int id = 0;
  Rights rights = Rights::view;
  std::string user;
  std::shared_ptr<Socket> socket;
  std::map<int, WantedView> views;  ///< by the number that the window gives them
  std::string cursor;               ///< JSON, "" where none
};

}  // namespace sg::serve
