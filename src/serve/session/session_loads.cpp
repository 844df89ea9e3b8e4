// SPDX-License-Identifier: Apache-2.0
// What is run and told of a pipeline before there are pictures.
#include "serve/session/session.h"

#include <algorithm>
#include <chrono>
#include <optional>

#include "base/error.h"
#include "pipeline/picture/picture.h"
#include "serve/renderer/same_picture.h"
#include "serve/renderer/tell.h"
#include "serve/session/command_text.h"
#include "serve/session/limits.h"
#include "serve/session/problem.h"
#include "serve/session/saved_picture.h"

namespace sg::serve {

namespace {

// Where a mistake belongs that only running has found: to what was just changed.
EditMistake mistake_of(const Json& change, const std::string& what) {
  const Json& edits = change["edits"];
  if (edits.size() == 0) return {"", "", what};
  const Json& last = edits[edits.size() - 1];
  return mistake_of_set(last["at"].text(), last["set"], what);
}

bool shows_automatically(const PipelineFile& file) {
  return file.show.empty() || std::any_of(file.show.begin(), file.show.end(), [](const auto& s) { return s.kind == auto_show; });
}

}  // namespace

void Session::load(std::unique_lock<std::mutex>& lock) {
  needs_load_ = false;
  PipelineFile file = history_.now();
  const Change change = last_change_;
  const bool looks_same = loaded_ && make_same_picture(file, good_) && shown_time_ == time_;
  const bool times_known = film_.has_value() && loaded_ && file.steps == good_.steps;
  Context& context = begin(beside_, Work::Kind::pipeline);
  std::optional<FilmTimes> film = film_;
  if (!looks_same) send_all({{"is", text("busy")}, {"revision", Json(revision_ + 1)}});
  lock.unlock();
  PipelineFile completed;
  std::string problem;
  bool cancelled = false;
  try {
    if (!times_known) try {
        film = film_times(file, "", context);
      } catch (const Error& e) {
        if (e.kind() == ErrorKind::cancelled) throw;
        film.reset();  // nothing has times
      }
    const bool moves = film && time_ && *time_ < film->times.size();
    completed = renderer_->load(moves ? at_time(file, *film, *time_) : file, context);
    // Looks that were chosen stay; a time is no part of the pipeline.
    if (moves) {
      if (!shows_automatically(file)) completed = file;
    }
  } catch (const Error& e) {
    cancelled = e.kind() == ErrorKind::cancelled, problem = e.what();
  } catch (const std::exception& e) {
    problem = problem_of(e);
  }
  lock.lock();
  end(beside_);
  if (cancelled && beside_.took_too_long)
    cancelled = false, problem = loaded_ ? took_too_long(longest_) : reading_took_too_long(title_, longest_);
  if (cancelled) {
    needs_load_ = !stopping_;
    return;
  }
  if (!problem.empty()) {
    refuse(change.client, change.message["n"].whole(), {mistake_of(change.message, problem)});
    if (loaded_) history_.complete(good_);       // the picture before it is left standing
    else failed_ = problem, needs_tell_ = true;  // so that the mistake can be mended
    return;
  }
  failed_.clear();
  history_.complete(completed);
  good_ = std::move(completed), film_ = std::move(film), loaded_ = true, needs_tell_ = true, tell_since_ = std::chrono::steady_clock::now();
  if (looks_same) return;  // what is drawn stays
  shown_time_ = time_;
  ++revision_;
  restart_views();
}

// Pictures that nobody sees, before there is a window: a small one, for what rays need to know of the data, then some from which the first
// picture knows how coarse it has to be so that it comes at once. Those stop as soon as somebody wants to see one.
void Session::warm_up(std::unique_lock<std::mutex>& lock) {
  cold_ = false;
  DrawRequest request;
  request.view = -1, request.quality = Quality::moving;
  const DrawRequest full = request;
  request.width = 64, request.height = 36;
  constexpr int most = 6;
  double coarse = 0;
  for (int i = 0; i < most && clients_.empty() && !stopping_ && settled(); ++i) {
    Context& context = begin(drawing_, i == 0 ? Work::Kind::pipeline : Work::Kind::unseen);
    lock.unlock();
    double drawn = coarse;
    try {
      drawn = renderer_->draw(request, context).coarse;
      if (i == 0) renderer_->forget(-1);
    } catch (const std::exception&) {  // the window is told when it asks
    }
    lock.lock();
    end(drawing_);
    if (i > 0 && drawn == coarse) break;
    coarse = i == 0 ? 0 : drawn, request = full;
  }
  lock.unlock();
  renderer_->forget(-1);
  lock.lock();
}

void Session::tell(std::unique_lock<std::mutex>& lock, Work& work) {
  needs_tell_ = false;
  const uint64_t revision = revision_, by = last_change_.message["n"].whole();
  const PipelineFile file = good_;
  const std::string failed = failed_;
  Context& context = begin(work, Work::Kind::state);
  lock.unlock();
  Json::Members told;
  bool cancelled = false;
  try {
    told = loaded_ ? renderer_->tell(context) : tell_pipeline(file);
    if (!failed.empty()) told.emplace_back("notes", list({failed}));
  } catch (const Error& e) {
    cancelled = e.kind() == ErrorKind::cancelled;
    told.emplace_back("notes", list({e.what()}));
  }
  lock.lock();
  end(work);
  if (cancelled) needs_tell_ = true;
  if (needs_tell_) return;  // something newer is to be told by now
  Json::Members state{{"is", text("state")},
                      {"revision", Json(revision)},
                      {"by", Json(by)},
                      {"can_undo", Json(history_.can_undo())},
                      {"can_redo", Json(history_.can_redo())},
                      {"title", text(title_)},
                      {"saves", Json(Json::Members{{"types", list(picture_types())}, {"most_pixels", number(most_pixels)}})},
                      {"pipeline", text(emit_pipeline(without_lent(file)))},
                      {"command", text(command_text(file))}};
  state.insert(state.end(), told.begin(), told.end());
  std::vector<Json> times;
  for (size_t i = 0; film_ && i < film_->times.size(); ++i) times.push_back(number(film_->times[i]));
  state.emplace_back("times", Json(std::move(times)));
  state.emplace_back("time", film_ && time_ && *time_ < film_->times.size() ? number(film_->times[*time_]) : Json());
  state_ = Json(state).dump();
  for (const auto& [id, client] : clients_) {
    Json::Members own = state;
    own.emplace_back("may_edit", Json(client->rights == Rights::edit));
    send(id, own);
  }
}

}  // namespace sg::serve
