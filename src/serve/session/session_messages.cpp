// SPDX-License-Identifier: Apache-2.0
// What comes in.
#include "serve/session/session.h"

#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/text/utf8.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/wish.h"
#include "serve/session/forbidden.h"
#include "serve/session/limits.h"
#include "serve/session/view_number.h"

namespace sg::serve {

namespace {

constexpr const char* too_much = "what this window has asked for and is not done yet is too large; wait for answers";
constexpr auto drag_pause = std::chrono::milliseconds(150);  // between two edits of a drag

// Which words edits set, as one text: "show/0 opacity;".
std::string words_of(const Json& edits) {
  std::string words;
  for (size_t i = 0; i < edits.size(); ++i) {
    words += edits[i]["at"].text();
    for (const auto& [word, value] : edits[i]["set"].members()) words += " " + word;
    words += ";";
  }
  return words;
}

}  // namespace

void Session::take_message(int id, std::string_view words) {
  Json message;
  try {
    message = parse_json(words, "message");
  } catch (const Error& e) {
    const std::lock_guard lock(mutex_);
    return refuse(id, 0, {{"", "", e.what()}});
  }
  const std::lock_guard lock(mutex_);
  const auto it = clients_.find(id);
  if (it == clients_.end()) return;
  Client& client = *it->second;
  try {
    const auto wish = wish_of(message);
    if (!wish) fail_usage(fmt::format("'{}' is no message", printable(message["do"].text())));
    if (*wish == Wish::draw) {
      take_draw(client, message);
    } else if (*wish == Wish::shown) {
      const auto view = client.views.find(view_number(message["view"]).value_or(-1));
      if (view != client.views.end()) {
        view->second.on_its_way = false, view->second.base = message["base"].whole();
        view->second.wait();
        make_way();
      }
    } else if (*wish == Wish::cursor) {
      take_cursor(client, message);
    } else if (*wish == Wish::together) {
      take_together(client, message);
    } else if (changes(*wish)) {
      if (client.rights != Rights::edit) fail_usage("this window may look, but not change anything");
      const auto own = std::count_if(changes_.begin(), changes_.end(), [&](const Change& c) { return c.client == id; });
      if (size_t(own) >= most_changes) fail_usage("there are more edits than can be made");
      if (!has_room(id, words.size())) fail_usage(too_much);
      changes_.push_back({id, message, words.size()});
      if (!drawing_.moves) drawing_.stop();
      beside_.stop();
    } else {
      if (!has_room(id, words.size())) fail_usage(too_much);
      if (!questions_.push({id, message, words.size()})) fail_usage("there are more questions than can be answered");
      questions_wait_.notify_all();
    }
  } catch (const Error& e) {
    refuse(id, message["n"].whole(), {{"", "", e.what()}});
  }
  work_.notify_all();
}

bool Session::has_room(int client, size_t bytes) const {
  size_t sum = bytes + questions_.bytes(client);
  for (const Change& c : changes_)
    if (c.client == client) sum += c.bytes;
  return sum <= most_waiting;
}

void Session::take_draw(Client& client, const Json& message) {
  const int number = stated_view(message["view"]);
  const double width = message["size"][0].number(), height = message["size"][1].number();
  if (!(width >= 1 && height >= 1 && width <= 32768 && height <= 32768 && width * height <= most_pixels))
    fail_usage("the size of a view is out of bounds", "size", "two numbers from 1 on, 4096 x 4096 pixels at most");
  const std::optional<ViewCamera> camera = stated_camera(message);
  WantedView& view = client.views[number];
  const bool moving = message["moving"].boolean();
  // What was drawn while the view moved serves as the first picture of the view at rest.
  const bool same = view.request.camera == camera && view.request.width == int(width) && view.request.height == int(height);
  if (view.request.width != int(width) || view.request.height != int(height)) view.whole = 0;
  const bool has_first = same && view.moving && !view.due;
  view.request = {client.id * most_views + number, int(width), int(height), camera, Quality::moving, {}};
  view.base = message["base"].whole();
  view.n = message["n"].whole(), view.moving = moving;
  view.restart();
  if (has_first && !moving) view.next = Quality::draft;
  view.wait();
  interrupt(view.request.view);
  make_way();
}

void Session::take_cursor(Client& client, const Json& message) {
  Json::Members cursor{{"id", Json(int64_t(client.id))},
                       {"view", Json(int64_t(view_number(message["view"]).value_or(0)))},
                       {"at", numbers({message["at"][0].number(), message["at"][1].number()})}};
  if (const auto camera = stated_camera(message)) cursor.emplace_back("camera", camera_json(*camera));
  client.cursor = Json(std::move(cursor)).dump();
  // Who only points has not moved the view.
  if (together_ && message["leads"].boolean()) common_ = stated_camera(message), leader_ = client.id;
  tell_people();
}

// All windows have one view from now on: that of whoever says so, then of whoever moves it.
void Session::take_together(Client& client, const Json& message) {
  together_ = message["on"].boolean();
  common_ = together_ ? stated_camera(message) : std::nullopt;
  leader_ = client.id;
  tell_people();
}

void Session::make_change(const Change& change) {
  const Json& m = change.message;
  const Wish wish = wish_of(m).value_or(Wish::edit);
  const uint64_t n = m["n"].whole();
  if (wish == Wish::undo) {
    history_.undo();
  } else if (wish == Wish::redo) {
    history_.redo();
  } else if (wish == Wish::time) {
    const double t = m["time"].number();
    if (!film_ || film_->times.empty()) return refuse(change.client, n, {{"", "", "nothing here changes with time"}});
    const auto& times = film_->times;
    const auto nearest =
        std::min_element(times.begin(), times.end(), [&](double a, double b) { return std::abs(a - t) < std::abs(b - t); });
    time_ = size_t(nearest - times.begin());
  } else {
    std::vector<EditMistake> mistakes;
    PipelineFile next;
    try {
      if (wish == Wish::pipeline) next = parse_pipeline(bytes_of_text(m["text"].text()), history_.now().origin, picture_vocabulary());
      else next = edited(history_.now(), m["edits"], mistakes);
      if (mistakes.empty()) mistakes = forbidden(good_, next);
    } catch (const Error& e) {
      mistakes.push_back({"", "", e.what()});
    }
    if (!mistakes.empty()) return refuse(change.client, n, mistakes);
    history_.change(std::move(next), m["live"].boolean(), words_of(m["edits"]));
  }
  live_ = m["live"].boolean();
  rest_at_ = live_ ? std::chrono::steady_clock::now() + drag_pause : std::chrono::steady_clock::time_point{};
  last_change_ = change, needs_load_ = true;
}

}  // namespace sg::serve
