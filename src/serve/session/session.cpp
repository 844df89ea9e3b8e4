// SPDX-License-Identifier: Apache-2.0
#include "serve/session/session.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text/text.h"
#include "base/text/utf8.h"
#include "pipeline/picture/picture.h"
#include "serve/guard/token.h"
#include "serve/renderer/tell.h"
#include "serve/session/command_text.h"

namespace sg::serve {

namespace {

constexpr size_t most_questions = 16, most_changes = 256, most_saved = 8;
constexpr int most_views = 4;
constexpr double most_pixels = 4096.0 * 4096.0;
constexpr auto progress_pause = std::chrono::milliseconds(200);

std::string frame_message(const DrawnView& drawn, const WantedView& view, int number, uint64_t revision, bool final) {
  const Json header(
      Json::Members{{"is", text("frame")},
                    {"n", Json(view.n)},
                    {"view", Json(int64_t(number))},
                    {"revision", Json(revision)},
                    {"type", text(drawn.type)},
                    {"size", numbers({double(drawn.width), double(drawn.height)})},
                    {"of", numbers({double(view.request.width), double(view.request.height)})},
                    {"coarse", Json(drawn.coarse)},
                    {"final", Json(final)},
                    {"camera", camera_json(drawn.camera)},
                    {"area", numbers({double(drawn.area[0]), double(drawn.area[1]), double(drawn.area[2]), double(drawn.area[3])})},
                    {"milliseconds", Json(1000 * drawn.seconds)}});
  const std::string head = header.dump();
  std::string message;
  message.reserve(4 + head.size() + drawn.bytes->size());
  for (int i = 0; i < 4; ++i) message += char(head.size() >> 8 * i & 255);
  return message + head + *drawn.bytes;
}

// Where a mistake belongs that only running has found: to what was just changed.
EditMistake mistake_of(const Json& change, const std::string& what) {
  EditMistake m{"", "", what};
  const Json& edits = change["edits"];
  if (edits.size() == 0) return m;
  const Json& last = edits[edits.size() - 1];
  m.at = last["at"].text();
  if (last["set"].size() == 1) m.word = last["set"].members()[0].first;
  return m;
}

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

bool shows_automatically(const PipelineFile& file) {
  return file.show.empty() || std::any_of(file.show.begin(), file.show.end(), [](const auto& s) { return s.kind == auto_show; });
}

}  // namespace

std::shared_ptr<Session> Session::open(std::unique_ptr<Renderer> renderer, PipelineFile file, std::string title) {
  std::shared_ptr<Session> s(new Session(std::move(renderer), std::move(file), std::move(title)));
  s->draws_ = std::thread([p = s.get()] { p->draw_thread(); });
  s->asks_ = std::thread([p = s.get()] { p->ask_thread(); });
  return s;
}

Session::Session(std::unique_ptr<Renderer> renderer, PipelineFile file, std::string title)
    : renderer_(std::move(renderer)), title_(std::move(title)), history_(file), good_(std::move(file)) {}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    if (running_) running_->cancel();
    if (asking_) asking_->cancel();
  }
  work_.notify_all(), questions_wait_.notify_all();
  if (draws_.joinable()) draws_.join();
  if (asks_.joinable()) asks_.join();
}

size_t Session::clients() const {
  const std::lock_guard lock(mutex_);
  return clients_.size();
}

std::optional<Saved> Session::saved(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  for (const auto& [known, saved] : saved_)
    if (same_secret(known, id)) return saved;
  return std::nullopt;
}

SocketHandler Session::join(Rights rights, const std::string& user, std::shared_ptr<Socket> socket) {
  const std::lock_guard lock(mutex_);
  const int id = next_client_++;
  auto client = std::make_unique<Client>();
  client->id = id, client->rights = rights, client->user = user, client->socket = std::move(socket);
  clients_[id] = std::move(client);
  if (!state_.empty()) {
    Json::Members own = parse_json(state_, "state").members();
    own.emplace_back("may_edit", Json(rights == Rights::edit));
    send(id, own);
  }
  tell_people();
  work_.notify_one();
  const std::weak_ptr<Session> self = weak_from_this();
  return {[self, id](std::string_view text) {
            if (const auto s = self.lock()) s->take_message(id, text);
          },
          [self, id] {
            if (const auto s = self.lock()) s->leave(id);
          }};
}

void Session::leave(int id) {
  const std::lock_guard lock(mutex_);
  const auto it = clients_.find(id);
  if (it == clients_.end()) return;
  for (const auto& [number, view] : it->second->views) interrupt(view.request.view);
  clients_.erase(it);
  std::erase_if(questions_, [&](const Question& q) { return q.client == id; });
  tell_people();
}

// ---- what comes in ----

void Session::take_message(int id, std::string_view words) {
  Json message;
  try {
    message = parse_json(words, "message");
  } catch (const Error& e) {
    const std::lock_guard lock(mutex_);
    return refuse(id, 0, {{"", "", e.what()}});
  }
  const std::string& what = message["do"].text();
  const std::lock_guard lock(mutex_);
  const auto it = clients_.find(id);
  if (it == clients_.end()) return;
  Client& client = *it->second;
  try {
    if (what == "draw") {
      take_draw(client, message);
    } else if (what == "shown") {
      const auto view = client.views.find(int(message["view"].number()));
      if (view != client.views.end()) view->second.on_its_way = false;
    } else if (what == "cursor") {
      take_cursor(client, message);
    } else if (what == "edit" || what == "undo" || what == "redo" || what == "pipeline" || what == "time") {
      if (client.rights != Rights::edit) fail_usage("this window may look, but not change anything");
      if (changes_.size() >= most_changes) fail_usage("there are more edits than can be made");
      changes_.push_back({id, message});
      if (running_) running_->cancel();
    } else if (what == "probe" || what == "rows" || what == "line" || what == "histogram" || what == "plane" || what == "save" ||
               what == "proposals") {
      // Of what is asked while the mouse moves only the last counts.
      if (what == "probe")
        std::erase_if(questions_, [&](const Question& q) { return q.client == id && q.message["do"].text() == "probe"; });
      if (questions_.size() >= most_questions) fail_usage("there are more questions than can be answered");
      questions_.push_back({id, message});
      questions_wait_.notify_one();
    } else {
      fail_usage(fmt::format("'{}' is no message", printable(what)));
    }
  } catch (const Error& e) {
    refuse(id, message["n"].whole(), {{"", "", e.what()}});
  }
  work_.notify_one();
}

void Session::take_draw(Client& client, const Json& message) {
  const int number = int(message["view"].number());
  if (number < 0 || number >= most_views) fail_usage(fmt::format("a window has views 0 to {}", most_views - 1));
  const double width = message["size"][0].number(), height = message["size"][1].number();
  if (!(width >= 1 && height >= 1 && width <= 32768 && height <= 32768 && width * height <= most_pixels))
    fail_usage("the size of a view is out of bounds", "size", "two numbers from 1 on, 4096 x 4096 pixels at most");
  std::optional<ViewCamera> camera;
  if (message.contains("camera") && !message["camera"].is_null()) camera = camera_from(message["camera"]);
  WantedView& view = client.views[number];
  const bool moving = message["moving"].boolean();
  // What was drawn while the view moved serves as the first picture of the view at rest.
  const bool same = view.request.camera == camera && view.request.width == int(width) && view.request.height == int(height);
  const bool has_first = same && view.moving && !view.due;
  view.request = {client.id * most_views + number, int(width), int(height), camera, Quality::moving, false};
  view.base = message["base"].whole();
  view.n = message["n"].whole(), view.moving = moving;
  view.restart();
  if (has_first && !moving) view.next = Quality::draft;
  interrupt(view.request.view);
}

void Session::take_cursor(Client& client, const Json& message) {
  Json::Members cursor{{"id", Json(int64_t(client.id))},
                       {"view", Json(int64_t(message["view"].number()))},
                       {"at", numbers({message["at"][0].number(), message["at"][1].number()})}};
  if (message.contains("camera") && !message["camera"].is_null())
    cursor.emplace_back("camera", camera_json(camera_from(message["camera"])));
  client.cursor = Json(std::move(cursor)).dump();
  tell_people();
}

void Session::interrupt(int view) {
  if (running_ && running_view_ == view) running_->cancel();
}

void Session::restart_views() {
  for (auto& [id, client] : clients_)
    for (auto& [number, view] : client->views) view.restart();
}

// ---- what goes out ----

void Session::send(int id, const Json::Members& message) {
  const auto it = clients_.find(id);
  if (it != clients_.end()) it->second->socket->send_text(Json(message).dump());
}

void Session::send_all(const Json::Members& message) {
  const std::string words = Json(message).dump();
  for (const auto& [id, client] : clients_) client->socket->send_text(words);
}

void Session::refuse(int id, uint64_t n, const std::vector<EditMistake>& mistakes) {
  std::vector<Json> errors;
  for (const EditMistake& m : mistakes)
    errors.emplace_back(Json::Members{{"at", text(m.at)}, {"word", text(m.word)}, {"text", text(m.text)}});
  send(id, {{"is", text("refused")}, {"n", Json(n)}, {"errors", Json(std::move(errors))}});
}

void Session::tell_people() {
  for (const auto& [id, client] : clients_) {
    std::vector<Json> cursors;
    for (const auto& [other, c] : clients_)
      if (other != id && !c->cursor.empty()) cursors.push_back(parse_json(c->cursor, "cursor"));
    client->socket->send_text(
        Json(Json::Members{{"is", text("people")}, {"count", Json(uint64_t(clients_.size()))}, {"cursors", Json(std::move(cursors))}})
            .dump());
  }
}

// ---- the thread that draws ----

void Session::draw_thread() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (!changes_.empty()) {
      const Change change = changes_.front();
      changes_.pop_front();
      make_change(change);
    } else if (needs_load_) {
      load(lock);
    } else if (auto [client, view] = next_view(true); view) {  // a picture at once, then what is told, then better pictures
      draw(lock, *client, *view);
    } else if (needs_tell_) {
      tell(lock);
    } else if (auto [any, finer] = next_view(false); finer) {
      draw(lock, *any, *finer);
    } else {
      work_.wait(lock);
    }
  }
}

Context& Session::begin_work(int view) {
  running_ = std::make_unique<Context>(), running_view_ = view;
  running_->on_progress = [this, last = std::chrono::steady_clock::time_point{}](double share, std::string_view doing) mutable {
    const auto now = std::chrono::steady_clock::now();
    if (now - last < progress_pause) return;
    last = now;
    const std::lock_guard lock(mutex_);
    send_all({{"is", text("progress")}, {"share", number(share)}, {"doing", text(std::string(doing))}});
  };
  return *running_;
}

void Session::make_change(const Change& change) {
  const Json& m = change.message;
  const std::string& what = m["do"].text();
  const uint64_t n = m["n"].whole();
  if (what == "undo" || what == "redo") {
    if (what == "undo") history_.undo();
    else history_.redo();
  } else if (what == "time") {
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
      if (what == "pipeline") next = parse_pipeline(bytes_of_text(m["text"].text()), history_.now().origin, picture_vocabulary());
      else next = edited(history_.now(), m["edits"], mistakes);
      if (mistakes.empty()) mistakes = forbidden(good_, next);
    } catch (const Error& e) {
      mistakes.push_back({"", "", e.what()});
    }
    if (!mistakes.empty()) return refuse(change.client, n, mistakes);
    history_.change(std::move(next), m["live"].boolean(), words_of(m["edits"]));
  }
  last_change_ = change, needs_load_ = true;
}

void Session::load(std::unique_lock<std::mutex>& lock) {
  needs_load_ = false;
  PipelineFile file = history_.now();
  const Change change = last_change_;
  const bool times_known = film_.has_value() && loaded_ && file.steps == good_.steps;
  Context& context = begin_work(-1);
  std::optional<FilmTimes> film = film_;
  send_all({{"is", text("busy")}, {"revision", Json(revision_ + 1)}});
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
    problem = e.what();
  }
  lock.lock();
  running_.reset();
  if (cancelled) {
    needs_load_ = !stopping_;
    return;
  }
  if (!problem.empty()) {
    refuse(change.client, change.message["n"].whole(), {mistake_of(change.message, problem)});
    if (loaded_) history_.complete(good_);  // the picture before it is left standing
    else needs_tell_ = true;                // so that the mistake can be mended
    return;
  }
  history_.complete(completed);
  good_ = std::move(completed), film_ = std::move(film), loaded_ = true, needs_tell_ = true;
  ++revision_;
  restart_views();
}

void Session::tell(std::unique_lock<std::mutex>& lock) {
  needs_tell_ = false;
  const uint64_t revision = revision_, by = last_change_.message["n"].whole();
  const PipelineFile file = good_;
  Context& context = begin_work(-1);
  lock.unlock();
  Json::Members told;
  bool cancelled = false;
  try {
    told = loaded_ ? renderer_->tell(context) : tell_pipeline(file);
  } catch (const Error& e) {
    cancelled = e.kind() == ErrorKind::cancelled;
    told.emplace_back("notes", list({e.what()}));
  }
  lock.lock();
  running_.reset();
  if (cancelled) {
    needs_tell_ = true;
    return;
  }
  Json::Members state{{"is", text("state")},
                      {"revision", Json(revision)},
                      {"by", Json(by)},
                      {"can_undo", Json(history_.can_undo())},
                      {"can_redo", Json(history_.can_redo())},
                      {"title", text(title_)},
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

// The view that has waited longest, moving ones and first pictures before others.
std::pair<Client*, WantedView*> Session::next_view(bool coarse_only) {
  std::pair<Client*, WantedView*> best{nullptr, nullptr};
  if (!loaded_) return best;
  const auto rank = [](const WantedView& v) { return std::tuple(v.next != Quality::moving, !v.moving, v.served); };
  for (auto& [id, client] : clients_)
    for (auto& [number, view] : client->views) {
      if (!view.due || view.on_its_way || (coarse_only && view.next != Quality::moving)) continue;
      if (!best.second || rank(view) < rank(*best.second)) best = {client.get(), &view};
    }
  return best;
}

void Session::draw(std::unique_lock<std::mutex>& lock, Client& client, WantedView& wanted) {
  const int id = client.id, renderer_view = wanted.request.view;
  WantedView view = wanted;
  const uint64_t revision = revision_;
  view.request.quality = view.next, view.request.part = view.base == revision;
  Context& context = begin_work(renderer_view);
  lock.unlock();
  DrawnView drawn;
  std::string problem;
  bool cancelled = false;
  try {
    drawn = renderer_->draw(view.request, context);
  } catch (const Error& e) {
    cancelled = e.kind() == ErrorKind::cancelled, problem = e.what();
  } catch (const std::exception& e) {
    problem = e.what();
  }
  const bool final = view.next == Quality::exact;
  std::shared_ptr<const std::string> message;
  if (problem.empty() && !cancelled)
    message = std::make_shared<const std::string>(frame_message(drawn, view, renderer_view % most_views, revision, final));
  lock.lock();
  running_.reset();
  const auto it = clients_.find(id);
  if (it == clients_.end()) {
    renderer_->forget(renderer_view);
    return;
  }
  WantedView& now = it->second->views[renderer_view % most_views];
  now.served = std::chrono::steady_clock::now();
  if (cancelled) return;
  const bool newer = now.n != view.n;
  if (!problem.empty()) {
    if (!newer) now.due = false;
    refuse(id, view.n, {{"", "", problem}});
    return;
  }
  if (newer && !(now.moving && view.moving)) return;  // another view is wanted; while both move, late is better than nothing
  now.on_its_way = it->second->socket->send_binary(message);
  if (newer || now.next != view.next) return;
  if (view.moving || final) now.due = false;
  else now.next = view.next == Quality::moving ? Quality::draft : Quality::exact;
}

// ---- the thread that answers ----

void Session::ask_thread() {
  std::unique_lock lock(mutex_);
  while (!stopping_) {
    if (questions_.empty()) {
      questions_wait_.wait(lock);
      continue;
    }
    const Question question = questions_.front();
    questions_.pop_front();
    answer(lock, question);
  }
}

void Session::answer(std::unique_lock<std::mutex>& lock, const Question& question) {
  const Json& m = question.message;
  const std::string& what = m["do"].text();
  const auto it = clients_.find(question.client);
  if (it == clients_.end()) return;
  Json asked = m;
  if (what == "probe") {  // the renderer knows the views of all windows
    Json::Members members = m.members();
    members.emplace_back("view", Json(uint64_t(question.client * most_views + int(m["view"].number()))));
    asked = Json(std::move(members));
  }
  DrawRequest picture;
  asking_ = std::make_unique<Context>();
  lock.unlock();
  Json::Members reply;
  std::string problem;
  std::optional<Saved> saved;
  try {
    if (what == "save") {
      picture.width = int(m["size"][0].number()), picture.height = int(m["size"][1].number());
      if (!(picture.width >= 1 && picture.height >= 1 && double(picture.width) * picture.height <= most_pixels))
        fail_usage("the size of the picture is out of bounds", "size");
      if (m.contains("camera") && !m["camera"].is_null()) picture.camera = camera_from(m["camera"]);
      std::string stem = title_.substr(0, title_.find('.'));
      const std::string name = (stem.empty() ? "picture" : stem) + ".png";
      saved = Saved{name, "image/png", std::make_shared<const std::string>(renderer_->save(picture, name, *asking_))};
    } else {
      reply = renderer_->answer(asked, *asking_);
    }
  } catch (const std::exception& e) {
    problem = e.what();
  }
  lock.lock();
  asking_.reset();
  if (!problem.empty()) return refuse(question.client, m["n"].whole(), {{"", "", problem}});
  Json::Members message{{"is", text(saved ? "saved" : what)}, {"n", m["n"]}};
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
