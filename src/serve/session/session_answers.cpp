// SPDX-License-Identifier: Apache-2.0
// The threads that answer questions.
#include "serve/session/session.h"

#include <fmt/core.h>

#include <chrono>

#include "base/error.h"
#include "base/text/utf8.h"
#include "serve/guard/token.h"
#include "serve/renderer/tell.h"
#include "serve/renderer/wish.h"
#include "serve/session/limits.h"
#include "serve/session/problem.h"
#include "serve/session/saved_picture.h"
#include "serve/session/view_number.h"

namespace sg::serve {

void Session::ask_thread(size_t which) {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (const auto question = questions_.pop(answering[which])) {
      answer(lock, asking_[which], *question);
      questions_.done(*question);
      questions_wait_.notify_all();  // another one of this window may be answered now, by any thread
    } else {
      questions_wait_.wait(lock);
    }
  }
}

namespace {

constexpr auto curve_pause = std::chrono::milliseconds(200);  // between two messages of how far it is

// The number that the renderer gives a view, which knows those of all windows.
Json renderer_view(int client, const Json& view) { return Json(uint64_t(client * most_views + stated_view(view))); }

// The question as the renderer understands it.
Json for_renderer(Wish wish, int client, const Json& question) {
  Json::Members members = question.members();
  if (wish == Wish::probe) {
    members.emplace_back("view", renderer_view(client, question["view"]));
  } else if (wish == Wish::measures && !question["among"]["view"].is_null()) {
    Json::Members among = question["among"].members();
    among.emplace_back("view", renderer_view(client, question["among"]["view"]));
    members.emplace_back("among", Json(std::move(among)));
  }
  return Json(std::move(members));
}

}  // namespace

// One time more of a field over time; the question then waits behind the others.
void Session::answer_next_time(std::unique_lock<std::mutex>& lock, Work& work, Question question) {
  const uint64_t n = question.message["n"].whole();
  if (!question.curve) {
    if (!loaded_ || !film_ || film_->times.empty()) return refuse(question.client, n, {{"", "", "nothing here changes with time"}});
    if (film_->times.size() > most_times)
      return refuse(question.client, n,
                    {{"", "", fmt::format("there are {} times, and {} can be asked for", film_->times.size(), most_times)}});
    question.curve = std::make_shared<TimeCurve>(TimeCurve{good_, *film_, {}, {}, ""});
  }
  TimeCurve& curve = *question.curve;
  Context& context = begin(work, Work::Kind::question, question.client, curve.spent);
  const auto began = std::chrono::steady_clock::now();
  lock.unlock();
  Json::Members reply, members = question.message.members();
  std::string problem;
  bool gap = false;  // a file that cannot be read leaves one; what is wrong with the question is wrong at the first time already
  try {
    members.emplace_back("pipeline", text(emit_pipeline(at_time(curve.file, curve.film, curve.values.size()))));
    members.emplace_back("origin", text(curve.file.origin));
    reply = renderer_->answer(Json(std::move(members)), context);
  } catch (const Error& e) {
    problem = e.what();
    gap = e.kind() == ErrorKind::data || (e.kind() == ErrorKind::usage && curve.gaps.size() < curve.values.size());
  } catch (const std::exception& e) {
    problem = problem_of(e);
  }
  lock.lock();
  end(work);
  curve.spent += std::chrono::steady_clock::now() - began;
  if (work.took_too_long) problem = took_too_long(longest_), gap = false;
  if (!clients_.contains(question.client)) return;
  const size_t known = curve.values.size() + 1, all = curve.film.times.size();
  const bool none = gap && known == all && curve.gaps.size() + 1 == all;
  if (!problem.empty() && (!gap || none)) return refuse(question.client, n, {{"", "", problem}});
  const Json told(std::move(reply));
  if (gap) curve.gaps.emplace_back(Json::Members{{"time", number(curve.film.times[curve.values.size()])}, {"text", text(problem)}});
  else curve.unit = bytes_of_text(told["unit"].text());
  curve.values.push_back(gap ? Json() : told["value"]);
  const auto now = std::chrono::steady_clock::now();
  if (known == all || now - curve.told > curve_pause) {
    curve.told = now;
    send(question.client, {{"is", text("progress")}, {"share", number(double(known) / double(all))}, {"doing", text("over time")}});
  }
  if (known < all) return void(questions_.push(std::move(question)));
  std::vector<Json> times;
  for (const double t : curve.film.times) times.push_back(number(t));
  send(question.client, {{"is", text(std::string(word_of(Wish::over_time)))},
                         {"n", Json(n)},
                         {"unit", text(curve.unit)},
                         {"times", Json(std::move(times))},
                         {"values", Json(curve.values)},
                         {"gaps", Json(curve.gaps)}});
}

// Without the mutex: what is loaded comes with it.
Saved Session::save(const Json& question, const Loaded& loaded, Context& context) {
  const PictureType type = picture_type(question["type"].text());
  DrawRequest picture;
  const double width = question["size"][0].number(), height = question["size"][1].number();
  if (!(width >= 1 && height >= 1 && width * height <= most_pixels))
    fail_usage("the size of the picture is out of bounds", "size",
               fmt::format("two numbers from 1 on, {:.0f} pixels in all at most", most_pixels));
  picture.width = int(width), picture.height = int(height);
  picture.camera = stated_camera(question);
  const std::string name = picture_stem(title_, loaded.file, loaded.film, loaded.time) + "." + std::string(type.word);
  const std::string place = pictures_in_.empty() ? name : pictures_in_ + "/" + name;
  return {name, std::string(type.media), std::make_shared<const std::string>(renderer_->save(picture, place, context))};
}

void Session::answer(std::unique_lock<std::mutex>& lock, Work& work, const Question& question) {
  const Json& m = question.message;
  const Wish wish = question.wish();
  const auto it = clients_.find(question.client);
  if (it == clients_.end()) return;
  if (wish == Wish::over_time) return answer_next_time(lock, work, question);
  const std::optional<Loaded> loaded = wish == Wish::save ? std::optional(Loaded{good_, film_, shown_time_}) : std::nullopt;
  Context& context = begin(work, Work::Kind::question, question.client);
  lock.unlock();
  Json::Members reply;
  std::string problem;
  std::optional<Saved> saved;
  try {
    if (loaded) saved = save(m, *loaded, context);
    else reply = renderer_->answer(for_renderer(wish, question.client, m), context);
  } catch (const std::exception& e) {
    problem = problem_of(e);
  }
  lock.lock();
  end(work);
  if (!problem.empty() && work.took_too_long) problem = took_too_long(longest_);
  if (!problem.empty()) return refuse(question.client, m["n"].whole(), {{"", "", problem}});
  Json::Members message{{"is", text(saved ? "saved" : std::string(word_of(wish)))}, {"n", m["n"]}};
  if (saved) {
    const std::string id = new_token();
    message.insert(message.end(), {{"url", text("/saved/" + id)}, {"name", text(saved->name)}});
    saved_.emplace_back(id, std::move(*saved));
    if (saved_.size() > most_saved) saved_.pop_front();
  }
  message.insert(message.end(), reply.begin(), reply.end());
  send(question.client, message);
}

}  // namespace sg::serve
