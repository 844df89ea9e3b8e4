// SPDX-License-Identifier: Apache-2.0
#include "render/volume/rays/joined_field.h"

#include <algorithm>

#include "render/volume/rays/integrate.h"

namespace sg::volume {

JoinedField::JoinedField(std::span<const RaySource* const> sources) {
  for (const RaySource* s : sources) {
    parts_.emplace_back();
    parts_.back().walker = s->walker(), parts_.back().rise = s->base - sources[0]->base;
  }
}

bool JoinedField::Part::peek() {
  if (next < count) return true;
  next = 0, count = walker->next(ahead);
  return count > 0;
}

void JoinedField::start(Vec3 origin, Vec3 direction, double from, double to) {
  for (Part& p : parts_) p.walker->start(origin, direction, from, to), p.next = p.count = 0;
  given_.clear();
  done_ = from;
}

size_t JoinedField::next(std::span<Stretch> out) {
  size_t n = 0;
  while (n < out.size()) {
    size_t nearest = parts_.size();
    for (size_t i = 0; i < parts_.size(); ++i)
      if (parts_[i].peek() &&
          (nearest == parts_.size() || parts_[i].ahead[parts_[i].next].from < parts_[nearest].ahead[parts_[nearest].next].from))
        nearest = i;
    if (nearest == parts_.size()) break;
    Part& p = parts_[nearest];
    Stretch s = p.ahead[p.next++];
    if (!(s.to > done_)) continue;
    if (s.from < done_) s = part_of(s, done_, s.to);
    done_ = s.to;
    given_.push_back({nearest, s.cell});
    s.cell = given_.size() - 1;
    for (float& b : s.b) b += p.rise;
    out[n++] = s;
  }
  return n;
}

double JoinedField::entry() const {
  double first = parts_[0].walker->entry();
  for (const Part& p : parts_) first = std::min(first, p.walker->entry());
  return first;
}

Stretch JoinedField::of_part(const Stretch& s) const {
  const Given& g = given_[size_t(s.cell)];
  Stretch own = s;
  own.cell = g.cell;
  for (float& b : own.b) b -= parts_[g.part].rise;
  return own;
}

Vec3f JoinedField::gradient(const Stretch& s, double t) { return walker(s).gradient(of_part(s), t); }
float JoinedField::second(const Stretch& s, double t) { return walker(s).second(of_part(s), t); }
bool JoinedField::bend(const Stretch& s, double t, SecondDerivatives& h) { return walker(s).bend(of_part(s), t, h); }
int JoinedField::samples(const Stretch& s, double t, float values[8], float shares[8]) {
  const int n = walker(s).samples(of_part(s), t, values, shares);
  for (int i = 0; i < n; ++i) values[i] += parts_[given_[size_t(s.cell)].part].rise;
  return n;
}

}  // namespace sg::volume
