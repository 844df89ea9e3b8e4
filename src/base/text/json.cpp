// SPDX-License-Identifier: Apache-2.0
#include "base/text/json.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include <nlohmann/json.hpp>

#include "base/error.h"

namespace sg {

namespace {

constexpr size_t many = 16;  ///< members, from which on they are looked up by an index

/// Places of the members in the order of their names, those of one name in the order of the file.
std::vector<uint32_t> order_of_names(const Json::Members& m) {
  std::vector<uint32_t> r(m.size());
  std::iota(r.begin(), r.end(), 0u);
  std::stable_sort(r.begin(), r.end(), [&](uint32_t a, uint32_t b) { return m[a].first < m[b].first; });
  return r;
}

/// Takes what the parser finds, from the inside to the outside.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  explicit TreeBuilder(const std::string& path) : path_(path) {}

  bool null() override { return put(Json()); }
  bool boolean(bool v) override { return put(Json(v)); }
  bool number_integer(number_integer_t v) override { return put(Json(int64_t(v))); }
  bool number_unsigned(number_unsigned_t v) override { return put(Json(uint64_t(v))); }
  bool number_float(number_float_t v, const string_t&) override { return put(Json(double(v))); }
  bool string(string_t& v) override { return put(Json(std::move(v))); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(true); }
  bool start_array(std::size_t) override { return open(false); }
  bool key(string_t& v) override {
    open_.back().key = std::move(v);
    return true;
  }
  bool end_object() override {
    Level l = close();
    return put(Json(std::move(l.members)));
  }
  bool end_array() override {
    Level l = close();
    return put(Json(std::move(l.list)));
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::json::exception& e) override {
    fail_data(fmt::format("is not valid JSON: {}", std::string(e.what()).substr(0, 200)), path_);
  }

  Json root;

 private:
  struct Level {
    std::vector<Json> list;
    Json::Members members;
    std::string key;
    bool object = false;
  };
  bool open(bool object) {
    if (open_.size() >= size_t(deepest_json)) fail_data(fmt::format("is nested more than {} deep", deepest_json), path_);
    open_.emplace_back().object = object;
    return true;
  }
  Level close() {
    Level l = std::move(open_.back());
    open_.pop_back();
    return l;
  }
  bool put(Json v) {
    if (open_.empty()) root = std::move(v);
    else if (Level& l = open_.back(); l.object) l.members.emplace_back(std::move(l.key), std::move(v));
    else l.list.push_back(std::move(v));
    return true;
  }

  const std::string& path_;
  std::vector<Level> open_;
};

nlohmann::ordered_json other(const Json& v) {
  if (v.is_bool()) return v.boolean();
  if (v.is_whole()) return v.whole();
  if (v.is_real()) return v.number();
  if (v.is_number()) return v.negative();
  if (v.is_text()) return v.text();
  if (v.is_list()) {
    auto r = nlohmann::ordered_json::array();
    for (const Json& i : v.items()) r.push_back(other(i));
    return r;
  }
  if (!v.is_object()) return nullptr;
  nlohmann::ordered_json::object_t r;
  for (const auto& [name, i] : v.members()) r.emplace_back(name, other(i));
  return r;
}

}  // namespace

Json::Json(Members members) {
  Object o{std::move(members), {}};
  if (o.members.size() > 1) {
    std::vector<uint32_t> order = order_of_names(o.members);
    std::vector<uint32_t> gone;
    for (size_t i = 0, first = 0; i < order.size(); ++i) {
      if (i > 0 && o.members[order[i]].first == o.members[order[first]].first)
        o.members[order[first]].second = std::move(o.members[order[i]].second), gone.push_back(order[i]);
      else first = i;
    }
    if (!gone.empty()) {
      std::sort(gone.begin(), gone.end());
      Members kept;
      for (uint32_t i = 0; i < o.members.size(); ++i)
        if (!std::binary_search(gone.begin(), gone.end(), i)) kept.push_back(std::move(o.members[i]));
      o.members = std::move(kept), order = order_of_names(o.members);
    }
    if (o.members.size() >= many) o.by_name = std::move(order);
  }
  value_ = std::make_shared<const Object>(std::move(o));
}

bool Json::boolean() const { return is_bool() && std::get<bool>(value_); }

uint64_t Json::whole() const { return is_whole() ? std::get<uint64_t>(value_) : 0; }

int64_t Json::negative() const { return is<int64_t>() ? std::get<int64_t>(value_) : 0; }

double Json::number() const {
  if (const auto* w = std::get_if<uint64_t>(&value_)) return double(*w);
  if (const auto* n = std::get_if<int64_t>(&value_)) return double(*n);
  return is_real() ? std::get<double>(value_) : 0;
}

const std::string& Json::text() const {
  static const std::string none;
  return is_text() ? *std::get<Shared<std::string>>(value_) : none;
}

size_t Json::size() const { return is_object() ? members().size() : items().size(); }

const Json& Json::operator[](size_t i) const {
  static const Json none;
  return i < items().size() ? items()[i] : none;
}

const Json* Json::find(std::string_view key) const {
  if (!is_object()) return nullptr;
  const Object* o = std::get<Shared<Object>>(value_).get();
  if (o->by_name.empty()) {
    const auto it = std::find_if(o->members.begin(), o->members.end(), [&](const auto& m) { return m.first == key; });
    return it == o->members.end() ? nullptr : &it->second;
  }
  const auto it =
      std::lower_bound(o->by_name.begin(), o->by_name.end(), key, [&](uint32_t i, std::string_view k) { return o->members[i].first < k; });
  return it != o->by_name.end() && o->members[*it].first == key ? &o->members[*it].second : nullptr;
}

const Json& Json::operator[](std::string_view key) const {
  static const Json none;
  const Json* found = find(key);
  return found ? *found : none;
}

const std::vector<Json>& Json::items() const {
  static const std::vector<Json> none;
  return is_list() ? *std::get<Shared<std::vector<Json>>>(value_) : none;
}

const Json::Members& Json::members() const {
  static const Members none;
  return is_object() ? std::get<Shared<Object>>(value_)->members : none;
}

std::string Json::dump() const { return other(*this).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace); }

Json parse_json(std::string_view text, const std::string& path) {
  TreeBuilder tree(path);
  nlohmann::json::sax_parse(text.begin(), text.end(), &tree);
  return std::move(tree.root);
}

}  // namespace sg
